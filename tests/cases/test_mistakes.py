"""Every case in `mistakes/` is refused with exactly the text beside it, and the cases cover every code.

CLEANCLI_REGENERATE=1 rewrites the expected texts; read the difference before keeping it.
"""

from __future__ import annotations

import os
import re
from pathlib import Path

import pytest

from support.cases import cases, expected_path, refusal

ROOT = Path(__file__).parents[2]
CASES = cases(Path(__file__).parent / "mistakes")
DOCUMENT = ROOT / "docs" / "diagnostics.md"
ELSEWHERE = {
    "E003": "tests/language/test_load.py",  # needs a path that the system refuses
    "E005": "tests/language/test_load.py",  # needs a file of 8 MiB
    "E006": "tests/language/test_edit.py",  # needs a file that changes meanwhile
    "E603": "tests/compiler/test_ground.py",  # no text leads to it: E307 is exact and comes first
    "E702": "tests/execution/test_journal.py",  # a journal is no .nid file
    "E705": "tests/report/test_run.py",  # a folder is no .nid file
    "E706": "tests/execution/test_resume.py",  # a checkpoint is no .nid file
    "E707": "tests/learning/test_gathered.py",  # it is about files of experience
    "E708": "tests/cli/test_learn_structure.py",  # so is it here
    "E801": "tests/language/test_rename.py",  # a rename is no file, here and below
    "E802": "tests/language/test_rename.py",
    "E803": "tests/language/test_rename.py",
    "E804": "tests/language/test_rename.py",
    "E901": "tests/cli/test_simulate.py",  # two domains disagree
    "E902": "tests/cli/test_simulate.py",  # an option asks for what no plan needs
    "E903": "tests/cli/test_plan.py",  # an option asks for a planner that cannot
    "E911": "tests/conversion/test_malformed.py",  # of libPRADA's files, here and below
    "E912": "tests/conversion/test_malformed.py",
    "E913": "tests/conversion/test_malformed.py",
    "E914": "tests/conversion/test_malformed.py",
    "E915": "tests/conversion/test_pddl_mistakes.py",  # of PPDDL files, here and below
    "E916": "tests/conversion/test_pddl_mistakes.py",
    "E917": "tests/conversion/test_pddl_mistakes.py",
    "E918": "tests/conversion/test_pddl_mistakes.py",
    "E919": "tests/conversion/test_export_ppddl.py",  # of what is written in other languages
    "W911": "tests/conversion/test_pddl_mistakes.py",
    "W912": "tests/conversion/test_pddl_mistakes.py",
}
"""Codes that no file can show by itself, and the tests that show them."""


@pytest.mark.parametrize("case", CASES, ids=lambda path: path.stem)
def test_message(case: Path) -> None:
    found, _ = refusal(case)
    expected = expected_path(case)
    if os.environ.get("CLEANCLI_REGENERATE"):
        expected.write_text(found, encoding="utf-8")
    assert found == expected.read_text(encoding="utf-8")
    assert "[" in found, "a case is a mistake"


@pytest.mark.parametrize("case", CASES, ids=lambda path: path.stem)
def test_place_lies_in_the_text(case: Path) -> None:
    for diagnostic in refusal(case)[1]:
        span = diagnostic.span
        if span is not None:
            path = (case if case.is_dir() else case.parent) / span.path
            assert 0 <= span.start <= span.end <= len(path.read_bytes().decode())


def test_there_are_many() -> None:
    assert len(CASES) >= 120


def _documented() -> list[str]:
    return re.findall(r"^### ([EW]\d{3})", DOCUMENT.read_text(encoding="utf-8"), re.MULTILINE)


def test_every_code_is_documented() -> None:
    modules = (ROOT / "src" / "cleancli").rglob("*.py")
    used = {code for m in modules for code in re.findall(r'"([EW]\d{3})"', m.read_text(encoding="utf-8"))}
    assert sorted(used) == _documented()


def test_every_code_has_a_case() -> None:
    texts = [expected_path(case).read_text(encoding="utf-8") for case in CASES]
    shown = {code for text in texts for code in re.findall(r"\[([EW]\d{3})\]", text)}
    assert set(_documented()) - shown == set(ELSEWHERE)
    for code, test in ELSEWHERE.items():
        assert code in (ROOT / test).read_text(encoding="utf-8")
