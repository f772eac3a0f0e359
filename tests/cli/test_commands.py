"""Commands as a user runs them, in a process of their own."""

from __future__ import annotations

import json
import os
import resource
import subprocess
import sys
from collections.abc import Callable
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

import pytest

from cleancli.api import provenance
from cleancli.cli.main import run

ROOT = Path(__file__).parent.parent.parent
DOMAIN = (ROOT / "domains" / "cleaning.nid").read_text(encoding="utf-8")
SCENE = (ROOT / "problems" / "two_groups.nid").read_text(encoding="utf-8")


def cleancli(*words: str | Path, cwd: Path, **environment: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "cleancli.cli.main", *map(str, words)],
        capture_output=True,
        text=True,
        cwd=cwd,
        env={**os.environ, **environment},
        timeout=120,
    )


def _spent_on_others() -> float:
    """Seconds of CPU that processes which this one started have taken, once they have ended."""
    return sum(resource.getrusage(resource.RUSAGE_CHILDREN)[:2])


def test_help_answers_at_once(tmp_path: Path) -> None:
    """The best of five, in seconds of CPU, so that a busy machine does not decide."""
    spent = []
    for _ in range(5):
        started = _spent_on_others()
        result = cleancli("--help", cwd=tmp_path)
        spent.append(_spent_on_others() - started)
        assert result.returncode == 0
        assert "execute" in result.stdout
    assert min(spent) < 0.3


def test_the_name_alone_prints_the_help(tmp_path: Path) -> None:
    bare, asked = cleancli(cwd=tmp_path), cleancli("--help", cwd=tmp_path)
    assert (bare.returncode, bare.stdout, bare.stderr) == (0, asked.stdout, "")
    assert len(bare.stdout.splitlines()) > 20


def test_the_help_lists_every_command_module() -> None:
    import click

    from cleancli.cli.command_table import COMMANDS
    from cleancli.cli.main import cli

    folder = ROOT / "src" / "cleancli" / "cli" / "commands"
    modules = {path.stem for path in folder.glob("*.py")} - {"__init__"}
    assert {name.replace("_", "-") for name in modules} == set(COMMANDS)
    context = click.Context(cli)
    assert {name: command.name for name in COMMANDS if (command := cli.get_command(context, name))} == {
        name: name for name in COMMANDS
    }


def bad_inputs() -> dict[str, tuple[str, str, list[str], list[str]]]:
    """Name -> (file name, content, command with FILE for it, what the message must hold)."""
    plan, scene = ["plan", "FILE", "three_areas"], ["plan", "cleaning", "FILE"]
    return {
        "unknown predicate": (
            "d.nid",
            DOMAIN.replace(
                "when dirt(?a), size(?a) = small, not", "when dirty(?a), size(?a) = small, not", 1
            ),
            plan,
            ["d.nid:31:10:", "dirty", "did you mean", "dirt"],
        ),
        "wrong arity": (
            "d.nid",
            DOMAIN.replace("near(?a, ?b), size(?b) = small", "near(?a), size(?b) = small"),
            plan,
            ["d.nid:", "near", "2"],
        ),
        "too much probability": (
            "d.nid",
            DOMAIN.replace(
                "         0.2: nothing\n         0.1: noise", "         0.3: nothing\n         0.1: noise"
            ),
            plan,
            ["d.nid:", "1.1", "0.1"],
        ),
        "unclosed brace": (
            "d.nid",
            DOMAIN.replace("    0.1: noise\n  }\n\n  default", "    0.1: noise\n\n  default"),
            plan,
            ["d.nid:"],
        ),
        "container off the table": (
            "s.nid",
            SCENE.replace("offset = 0 cm", "offset = 40 cm"),
            scene,
            ["s.nid:7:37:", "container", "edge"],
        ),
        "binary file": ("d.nid", "\x00\x01\x02" * 100, plan, ["d.nid", "text"]),
    }


@pytest.mark.parametrize("name", bad_inputs())
def test_bad_input_is_located_and_never_a_traceback(name: str, tmp_path: Path) -> None:
    file, content, words, expected = bad_inputs()[name]
    assert content not in (DOMAIN, SCENE), "the mistake is not in the text"
    (tmp_path / file).write_text(content, encoding="utf-8")
    result = cleancli(*[file if word == "FILE" else word for word in words], cwd=tmp_path)
    assert result.returncode == 1, result.stderr
    assert result.stdout == ""
    assert "Traceback" not in result.stderr
    assert "error[E" in result.stderr
    for words_of_message in expected:
        assert words_of_message in result.stderr


def test_missing_file_says_what_there_is(tmp_path: Path) -> None:
    result = cleancli("plan", "cleening", "three_areas", cwd=tmp_path)
    assert result.returncode == 1
    assert "cleening" in result.stderr
    assert "cleaning" in result.stderr
    assert "Traceback" not in result.stderr


def test_check_reports_all_files(tmp_path: Path) -> None:
    (tmp_path / "bad.nid").write_text(DOMAIN.replace("rest: noise", "0.5: noise"), encoding="utf-8")
    result = cleancli("check", "cleaning", "bad.nid", "nowhere", "--json", cwd=tmp_path)
    assert result.returncode == 1
    found = json.loads(result.stdout)
    assert {entry["path"] for entry in found if entry["path"]} == {"bad.nid"}
    assert len(found) > 10
    assert (
        cleancli("check", "cleaning", "two_groups", "scattered_40", "three_areas", cwd=tmp_path).returncode
        == 0
    )


def test_plan_says_how_it_came_about(tmp_path: Path) -> None:
    asked = ("plan", "cleaning", "three_areas", "--seed", "3", "--planner", "prada", "--json")
    result = cleancli(*asked, cwd=tmp_path)
    assert result.returncode == 0, result.stderr
    data = json.loads(result.stdout)
    assert (data["planner"], data["samples"]) == ("prada", 10_000)
    assert data["horizon"] == 4
    assert data["value"] > 1.5
    assert 0 < data["coverage"] <= 1
    assert {"ground", "lower", "search"} <= data["seconds"].keys()
    again = json.loads(cleancli(*asked, cwd=tmp_path).stdout)
    assert again["plan"] == data["plan"]
    assert again["value"] == data["value"]


def test_learn_writes_only_when_told(tmp_path: Path) -> None:
    domain = tmp_path / "mine.nid"
    domain.write_text(DOMAIN, encoding="utf-8")
    facts = [["dirt", ["a1"], True], ["scattered", ["a1"], True], ["size", ["a1"], "big"]]
    transition = {
        "action": "groupScattered",
        "arguments": ["a1"],
        "objects": {"a1": "area"},
        "before": facts,
        "after": [facts[0], facts[2]],
    }
    (tmp_path / "experience.jsonl").write_text(json.dumps(transition) + "\n", encoding="utf-8")
    shown = cleancli("learn", "mine.nid", "experience.jsonl", cwd=tmp_path)
    assert shown.returncode == 0, shown.stderr
    assert "+    then 0.4546 [prior 0.4, seen 1]: not scattered(?a)" in shown.stdout
    assert domain.read_text(encoding="utf-8") == DOMAIN
    assert cleancli("learn", "mine.nid", tmp_path, "--write", cwd=tmp_path).returncode == 0
    learned = domain.read_text(encoding="utf-8")
    assert learned != DOMAIN
    assert cleancli("learn", "mine.nid", tmp_path, "--write", cwd=tmp_path).returncode == 0
    assert domain.read_text(encoding="utf-8") == learned
    shipped = cleancli("learn", "cleaning", tmp_path, "--write", cwd=tmp_path)
    assert shipped.returncode == 2
    assert "copy" in shipped.stderr


def test_without_pybullet_a_table_is_missing_and_what_to_install_is_said(tmp_path: Path) -> None:
    (tmp_path / "pybullet.py").write_text("raise ImportError('not installed')\n", encoding="utf-8")
    result = cleancli("execute", "cleaning", "two_groups", cwd=tmp_path, PYTHONPATH=str(tmp_path))
    assert result.returncode == 4
    assert "pip install" in result.stderr
    assert "Traceback" not in result.stderr


def test_a_run_is_recorded_and_goes_on_without_what_another_machine_has(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """No library but those that a symbolic run needs is asked for its version."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setitem(sys.modules, "pybullet", None)
    monkeypatch.setattr(provenance, "version", _without("pybullet", version))
    words = ["execute", "cleaning", "three_areas", "--seed", "5", "--samples", "50", "--quiet"]
    assert run([*words, "--max-actions", "1"]) in (0, 3)
    path = tmp_path / "runs" / "three_areas-seed5-001" / "run.json"
    told = json.loads(path.read_text())
    assert "pybullet" not in told["versions"]
    del told["episode"], told["truth"]
    told["versions"]["pybullet"] = "3.2.7"
    path.write_text(json.dumps(told))
    assert run(["execute", "--resume", str(path.parent), "--quiet"]) in (0, 3)
    assert "began with pybullet 3.2.7, which is not installed here" in capsys.readouterr().err


def _without(name: str, version: Callable[[str], str]) -> Callable[[str], str]:
    def found(library: str) -> str:
        if library == name:
            raise PackageNotFoundError(library)
        return version(library)

    return found


@pytest.mark.needs_pybullet
def test_record_that_cannot_be_written_is_an_error_before_motion(tmp_path: Path) -> None:
    (tmp_path / "runs").write_text("a file where the folder should be", encoding="utf-8")
    result = cleancli("execute", "cleaning", "two_groups", cwd=tmp_path)
    assert result.returncode == 5
    assert "runs" in result.stderr
    assert "Traceback" not in result.stderr


def test_check_prints_warnings_and_passes(tmp_path: Path) -> None:
    path = tmp_path / "d.nid"
    path.write_text("domain d { types { shelf } actions { wait() } reward { cost } }")
    result = cleancli("check", path, cwd=tmp_path)
    assert result.returncode == 0
    assert "warning[W201]" in result.stdout
    assert "0 mistakes and 2 warnings in 1 file" in result.stdout


def test_a_command_leaves_the_collector_running_and_nothing_for_it_to_search() -> None:
    code = (
        "import atexit, gc; from cleancli.cli.main import main;"
        " atexit.register(lambda: print(gc.isenabled(), gc.get_threshold() == before,"
        " len(gc.get_objects())));"
        " before = gc.get_threshold(); main(['compile', 'cleaning', 'three_areas'])"
    )
    result = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    *_, told = result.stdout.splitlines()
    running, unchanged, objects = told.split()
    assert (running, unchanged) == ("True", "True")
    assert int(objects) < 1000, "of more than 50,000"


def test_a_process_that_has_planned_arm_motions_ends_in_silence() -> None:
    """What stays alive at the end of a process, OMPL's bindings tell of as leaks."""
    code = "from ompl import base, geometric, util; from cleancli.cli.main import main; main(['--version'])"
    result = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert result.stderr == ""


def test_the_command_is_a_module_too() -> None:
    result = subprocess.run([sys.executable, "-m", "cleancli", "--version"], capture_output=True, check=True)
    assert result.stdout.startswith(b"cleancli")
