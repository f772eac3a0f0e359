"""The commands that the documents show do what they say: each runs, in the page's order, and succeeds."""

from __future__ import annotations

import re
import shlex
import shutil
from pathlib import Path

import pytest

from cleancli.cli.main import run

ROOT = Path(__file__).parent.parent
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]


def commands(page: Path) -> list[list[str]]:
    """Arguments of every `cleancli ...` line in the page's sh blocks."""
    blocks = re.findall(r"^```sh\n(.*?)^```$", page.read_text(encoding="utf-8"), re.M | re.S)
    lines = [line for block in blocks for line in block.splitlines()]
    return [shlex.split(line, comments=True) for line in lines if line.startswith("cleancli ")]


@pytest.mark.parametrize("page", [p for p in PAGES if commands(p)], ids=lambda p: p.stem)
def test_commands_of_the_page_succeed(page: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    shutil.copy(ROOT / "domains" / "cleaning.nid", tmp_path / "my_cleaning.nid")
    shutil.copytree(ROOT / "tests" / "conversion" / "kitchen", tmp_path / "kitchen")
    for words in commands(page):
        assert run(words[1:]) == 0, shlex.join(words)


def test_links_lead_somewhere() -> None:
    for page in [*PAGES, ROOT / "ARCHITECTURE.md"]:
        for target in re.findall(r"\]\(([^)#:]+)\)", page.read_text(encoding="utf-8")):
            assert (page.parent / target).exists(), f"{page.name} -> {target}"


def test_readme_states_the_two_commands() -> None:
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    assert "<!-- test command -->\n```sh\n" in text, ".ci/run finds the test command by this mark"
    assert "cleancli execute cleaning two_groups --seed 1\n" in text
