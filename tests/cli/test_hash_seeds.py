"""What commands say hangs on their inputs alone: not on how this process of Python happens to hash names."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

from support.golden import GOLDEN
from support.tower import BASE, DOMAIN, PROBLEM

ROOT = Path(__file__).parents[2]
COMMANDS = """\
check tower.nid two.nid mistakes.nid elsewhere.nid
check unreached.nid
show tower.nid two.nid --json
compile tower.nid two.nid
explain tower.nid two.nid wipe(b2)
rename load weight two.nid --domain tower.nid
simulate tower.nid two.nid --world elsewhere.nid
convert kitchen --out out
learn table.nid experience.jsonl
learn --structure --vocabulary table.nid experience.jsonl --diff
fmt --diff mistakes.nid table.nid
"""
SCRIPT = """
import sys
from pathlib import Path
from cleancli.cli.main import run
for line in sys.stdin.read().splitlines():
    print(line, int(run(line.split())), flush=True)
for path in sorted(Path().rglob("out*/*.nid")):
    print(path.read_text())
"""
OTHER = {
    "dirty": "grubby",
    "wet": "moist",
    "below": "beneath",
    "at": "upon",
    "load": "cargo",
    "lift": "raise",
}


def said(folder: Path, seed: int) -> str:
    folder.mkdir()
    elsewhere = DOMAIN.replace("tower", "elsewhere").replace('include "parts/base.nid"', BASE[14:-3])
    for old, new in OTHER.items():
        elsewhere = elsewhere.replace(f"{old}(", f"{new}(").replace(f"closure {old}", f"closure {new}")
    never = " ".join(f"h{number}" for number in range(9))
    unreached = PROBLEM.replace("s1 s2 - shelf", f"s1 s2 {never} - shelf")
    wanted = ", ".join(f"at(b1, {name})" for name in never.split())
    texts = {
        "parts/base": BASE,
        "tower": DOMAIN,
        "two": PROBLEM,
        "elsewhere": elsewhere,
        "unreached": unreached.replace("goal    { ", f"goal    {{ {wanted}, "),
    }
    for name, text in texts.items():
        (folder / name).parent.mkdir(exist_ok=True)
        (folder / f"{name}.nid").write_text(text, encoding="utf-8")
    for name, copy in (("domain", "table"), ("problem", "four"), ("mistakes", "mistakes")):
        shutil.copy(GOLDEN / f"{name}.nid", folder / f"{copy}.nid")
    shutil.copy(GOLDEN / "experience.jsonl", folder)
    shutil.copytree(ROOT / "tests" / "conversion" / "kitchen", folder / "kitchen")
    ended = subprocess.run(
        [sys.executable, "-c", SCRIPT],
        input=COMMANDS,
        capture_output=True,
        text=True,
        cwd=folder,
        env={**os.environ, "PYTHONHASHSEED": str(seed)},
        timeout=120,
    )
    assert ended.returncode == 0, ended.stderr
    return ended.stdout + ended.stderr


def test_another_hash_seed_says_the_same(tmp_path: Path) -> None:
    first, second = (said(tmp_path / str(seed), seed).splitlines() for seed in (1, 2))
    assert first == second
    assert sum("[E901]" in line for line in first) >= len(OTHER)
    assert any("[W403]" in line and "or 6 more" in line for line in first)
    assert len(first) > 300
