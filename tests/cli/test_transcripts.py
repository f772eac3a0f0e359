"""What commands print, word for word: each file of tests/golden/transcripts holds commands and their output.

CLEANCLI_REGENERATE=1 writes them anew; read the difference before keeping it. Seconds are those of a clock
that stands still, and numbers with many digits are rounded, so that no machine matters.
"""

from __future__ import annotations

import re
import shlex
import shutil
import time
from pathlib import Path

import pytest

from cleancli.cli.main import run
from support.golden import GOLDEN, check_golden
from support.tower import BASE, DOMAIN, PROBLEM

ROOT = Path(__file__).parents[2]

TRANSCRIPTS = {
    "check": (
        "check tower.nid two.nid",
        "check tower.nid two.nid --json",
        "check mistakes.nid",
        "check mistakes.nid --json",
        "check mistakes.nid --format sarif",
        "check tower.nid no_such_file.nid",
        "check table.nid odd.nid",
    ),
    "fmt": (
        "fmt --check table.nid two.nid",
        "fmt --diff table.nid",
        "fmt table.nid",
        "fmt --check table.nid",
    ),
    "show": (
        "show tower.nid",
        "show tower.nid two.nid",
        "show tower.nid --json",
        "show tower.nid two.nid --json",
        "show table.nid four.nid --samples 500",
        "show cleaning three_areas --json",
    ),
    "init": ("init", "init mine", "check mine", "init mine"),
    "explain": (
        "explain tower.nid two.nid 'wipe(b1)'",
        "explain tower.nid two.nid 'wipe(b2)'",
        "explain tower.nid two.nid 'lift(b1)' --json",
        "explain tower.nid two.nid 'lift(b2)'",
        "explain table.nid four.nid 'push(a1)'",
        "explain table.nid four.nid 'join(a1, a3)' --json",
        "explain table.nid four.nid 'join(a1, a4)'",
        "explain table.nid four.nid 'gather(a1)'",
        "explain table.nid four.nid 'gather(a9)'",
        "explain table.nid four.nid 'gathr(a1)'",
        "explain table.nid four.nid 'join(a1)'",
    ),
    "compile": (
        "compile tower.nid two.nid",
        "compile tower.nid two.nid --json",
        "compile cleaning three_areas",
    ),
    "plan": (
        "plan table.nid four.nid --planner prada --samples 300 --seed 3 --explain",
        "plan table.nid four.nid --planner prada+ --samples 300 --seed 3 --option solve=0",
        "plan table.nid four.nid --planner aprada --samples 300 --seed 3",
        "plan table.nid four.nid --planner exact --explain",
        "plan table.nid four.nid --planner uct --samples 300 --seed 3",
        "plan table.nid four.nid --planner sst --seed 3 --option depth=1",
        "plan table.nid four.nid --planner likeliest",
        "plan table.nid four.nid --planner all-outcomes",
        "plan table.nid four.nid --planner prada --samples 300 --json",
        "plan table.nid four.nid --compare prada,exact,likeliest --samples 300 --seed 3",
        "plan table.nid four.nid --compare prada,exact --samples 300 --seed 3 --json",
        "plan table.nid four.nid --evaluate 'push(a1) join(a2, a3)' --explain",
        "plan table.nid four.nid --evaluate 'push(a1) join(a2, a3)' --json",
        "plan table.nid four.nid --evaluate 'push(a1) pusch(a2)'",
        "plan table.nid four.nid --objective time",
        "plan table.nid four.nid --planner prada --compat libprada --samples 300 --seed 3",
        "plan tower.nid two.nid --explain",
        "plan tower.nid two.nid --planner exact --json",
        "plan table.nid two.nid",
    ),
    "simulate": (
        "simulate table.nid four.nid --episodes 20 --planner exact --seed 4",
        "simulate table.nid four.nid --episodes 3 --planner exact --planner prada --samples 99 --json",
        "simulate tower.nid two.nid --episodes 5 --commit 1 --max-actions 4 --seed 4",
        "simulate tower.nid two.nid --episodes 5 --objective time",
    ),
    "learn": (
        "learn table.nid experience.jsonl",
        "learn table.nid experience.jsonl --json",
        "learn table.nid experience.jsonl --estimator m --m 3",
        "learn table.nid experience.jsonl --write",
        "learn tower.nid experience.jsonl",
    ),
    "convert": (
        "convert kitchen --out out",
        "convert kitchen --out out",
        "convert kitchen --out out --force --json --predicates --horizon 3",
        "convert kitchen --out out2 --reward 'decrease(dirtyy)'",
        "convert tidy/tidy.pddl tidy/tidy_two.pddl --out tidied",
        "check tidied",
        "convert tidy/tidy.pddl --out out3 --json",
        "convert tidy/tidy_two.pddl --out out4",
        "convert tidy/tidy.pddl --out out4 --predicates",
        "convert tidy.rddl --out out4",
        "convert tower.nid two.nid --to ppddl --out written",
        "convert tower.nid two.nid --to rddl --out written --json",
        "convert tower.nid two.nid --to libprada --out written",
        "convert tower.nid --out written",
    ),
    "rename": (
        "rename dirty grubby two.nid --domain tower.nid",
        "rename load weight two.nid --domain tower.nid --write",
        "check tower.nid two.nid",
        "rename dirty wet two.nid --domain tower.nid",
        "rename nothing_such other --domain tower.nid",
    ),
    "execute": (
        "execute cleaning three_areas --seed 5 --samples 100 --planner prada --runs runs",
        "execute cleaning three_areas --seed 6 --samples 100 --planner prada --runs runs --json",
        "execute tower.nid two.nid --seed 2 --max-actions 2 --runs runs",
        "report runs/three_areas-seed5-001",
        "report runs/three_areas-seed5-001 --json",
        "report runs/three_areas-seed5-001 runs/three_areas-seed6-001 runs/two_boxes-seed2-001",
        "report runs/none",
    ),
}


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with the files that the commands name, and a clock that stands still."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(time, "perf_counter", lambda: 0.0)
    (tmp_path / "parts").mkdir()
    for name, text in (("parts/base.nid", BASE), ("tower.nid", DOMAIN), ("two.nid", PROBLEM)):
        (tmp_path / name).write_text(text, encoding="utf-8")
    for name, copy in (("domain", "table"), ("problem", "four"), ("mistakes", "mistakes")):
        shutil.copy(GOLDEN / f"{name}.nid", tmp_path / f"{copy}.nid")
    shutil.copy(GOLDEN / "experience.jsonl", tmp_path)
    for folder in ("kitchen", "tidy"):
        shutil.copytree(ROOT / "tests" / "conversion" / folder, tmp_path / folder)
    odd = PROBLEM.replace("tower", "table").replace("b1 b2 - box", "b1 b2 - area")
    (tmp_path / "odd.nid").write_text(odd, encoding="utf-8")
    return tmp_path


def alike(text: str, folder: Path) -> str:
    """What a command prints, on any machine: processors differ in the last digits of long numbers, runs tell
    versions and where files lie, and only the first of all plans compiles the planner."""
    text = text.replace(str(folder), "HERE").replace(str(ROOT), "ROOT")
    text = re.sub(r'\bcompile( 0\.000|": 0\.0)', r"load\1", text)
    text = re.sub(r'"versions": \{[^}]*\}', '"versions": {}', text)
    text = re.sub(r'"sha256": "[0-9a-f]{64}"', '"sha256": ""', text)
    return re.sub(r"-?\d+\.\d{7,}(e-?\d+)?", lambda number: f"{float(number[0]):.6g}", text)


def said(line: str, folder: Path, capsys: pytest.CaptureFixture[str]) -> str:
    """A command line as in a terminal: what it prints, what it prints as errors, and how it ends."""
    code = run(shlex.split(line))
    printed = capsys.readouterr()
    out, err = (alike(text, folder) for text in (printed.out, printed.err))
    errors = f"(to standard error)\n{err}" if err else ""
    return f"$ cleancli {line}\n{out}{errors}(exit code {code})\n"


@pytest.mark.parametrize("name", TRANSCRIPTS)
def test_commands_print_what_they_printed(name: str, here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text = "\n".join(said(line, here, capsys) for line in TRANSCRIPTS[name])
    check_golden(f"transcripts/{name}.txt", text)
