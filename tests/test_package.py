"""The wheel, installed into an empty environment, plans and acts from another folder with what it ships, and
needs pybullet for tables alone."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import venv
from pathlib import Path

ROOT = Path(__file__).parent.parent


def test_wheel_plans_from_another_folder(tmp_path: Path) -> None:
    wheels = tmp_path / "wheels"
    pip = [sys.executable, "-m", "pip", "--disable-pip-version-check"]
    subprocess.run(
        [*pip, "wheel", "-q", "--no-deps", "--no-build-isolation", "-w", wheels, ROOT],
        check=True,
        cwd=tmp_path,
    )
    (wheel,) = wheels.glob("cleancli-*.whl")
    environment = tmp_path / "empty"
    venv.create(environment, with_pip=False)
    python = environment / "bin" / "python"
    subprocess.run([*pip, "--python", python, "install", "-q", wheel], check=True, cwd=tmp_path)
    clean = {key: value for key, value in os.environ.items() if key != "PYTHONPATH"}

    def cleancli(*words: str) -> subprocess.CompletedProcess[str]:
        command = [str(environment / "bin" / "cleancli"), *words]
        return subprocess.run(command, capture_output=True, text=True, cwd=tmp_path, env=clean)

    planned = cleancli("plan", "cleaning", "three_areas", "--samples", "500", "--json")
    assert planned.returncode == 0, planned.stderr
    assert json.loads(planned.stdout)["plan"]
    subprocess.run([*pip, "--python", python, "uninstall", "-q", "-y", "pybullet"], check=True, cwd=tmp_path)
    acted = cleancli("execute", "cleaning", "three_areas", "--seed", "5", "--samples", "50", "--json")
    assert acted.returncode == 0, acted.stderr
    told = json.loads(acted.stdout)
    assert told["episode"]["clean"]
    assert "pybullet" not in told["versions"]
    table = cleancli("execute", "cleaning", "two_groups")
    assert table.returncode == 4
    assert "pybullet" in table.stderr
