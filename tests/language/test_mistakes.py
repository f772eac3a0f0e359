"""Every file in `mistakes/` is refused with exactly the text beside it.

CLEANCLI_REGENERATE=1 rewrites the expected texts; read the difference before keeping it.
"""

from __future__ import annotations

import os
import re
from pathlib import Path

import pytest

from cleancli.language.diagnostics import Refused, Source
from cleancli.language.load import checked_domain, checked_problem, kind_of, load_domain, read_source
from cleancli.language.render import render
from cleancli.scene.check import load_scene

HERE = Path(__file__).parent
FILES = sorted((HERE / "mistakes").glob("*.nid"))
PACKAGE = HERE.parents[1] / "src" / "cleancli"
DOCUMENT = HERE.parents[1] / "docs" / "diagnostics.md"


def _refusal(path: Path) -> str:
    """What a check finds; a problem is for `small`, or for the domain of its name in `parts/`."""
    own = path.parent / "parts" / path.name
    try:
        source = Source(path.name, read_source(path).text)
        match kind_of(source):
            case "domain":
                domain = checked_domain(source)
                return render(domain.diagnostics, domain.sources)
            case "problem":
                for_domain = load_domain(read_source(own if own.exists() else HERE / "small.nid"))
                problem = checked_problem(source, for_domain)
                return render(problem.diagnostics, problem.sources)
            case _:
                load_scene(source)
    except Refused as refused:
        return render(refused.diagnostics, refused.sources).replace(str(path), path.name)
    return "no mistake found\n"


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_message(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(path.parent)
    found = _refusal(path)
    expected = path.with_suffix(".txt")
    if os.environ.get("CLEANCLI_REGENERATE"):
        expected.write_text(found, encoding="utf-8")
    assert found == expected.read_text(encoding="utf-8")
    assert "error[" in found or "warning[" in found


def _codes(folder: Path) -> set[str]:
    modules = folder.rglob("*.py")
    return {code for m in modules for code in re.findall(r'"([EW]\d{3})"', m.read_text(encoding="utf-8"))}


def test_every_code_is_documented() -> None:
    documented = re.findall(r"^### ([EW]\d{3})", DOCUMENT.read_text(encoding="utf-8"), re.MULTILINE)
    assert sorted(_codes(PACKAGE)) == documented


def test_every_code_of_a_check_has_a_file_here() -> None:
    texts = [path.with_suffix(".txt").read_text(encoding="utf-8") for path in FILES]
    shown = {code for text in texts for code in re.findall(r"\[([EW]\d{3})\]", text)}
    wanted = {code for code in _codes(PACKAGE / "language") | _codes(PACKAGE / "scene") if code > "E1"}
    assert wanted - shown == {"E106"}, "E106 needs two kinds of file: see test_load"
