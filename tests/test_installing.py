"""What users are told to install is right: `cleancli` on the package index is another project's name."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
EXTRAS = PROJECT["optional-dependencies"]
MESSAGES = {
    "bags": "src/cleancli/perception/bag_file.py",
    "experiments": "src/cleancli/cli/commands/experiment.py",
    "lsp": "src/cleancli/cli/commands/lsp.py",
    "physics": "src/cleancli/world/errors.py",
    "plot": "src/cleancli/cli/views/plan_picture.py",
    "rerun": "src/cleancli/perception/rerun_file.py",
}
"""Extras, and the modules whose messages name what is missing."""
_INSTALLED = re.compile(r"pip[0-9]* install [^`\n]*")


def texts() -> dict[str, str]:
    """What a user may read of the project, by its paths."""
    found = [ROOT / "README.md", ROOT / "CHANGELOG.md", ROOT / "ARCHITECTURE.md"]
    for folder in ("src", "docs", "editors", "benchmarks", "domains", "problems"):
        paths = sorted((ROOT / folder).rglob("*"))
        found += [path for path in paths if path.suffix in {".md", ".py", ".nid", ".json", ".txt"}]
    return {str(path): path.read_text(encoding="utf-8") for path in found if path.is_file()}


def test_nothing_tells_to_install_a_stranger() -> None:
    told = [(name, words) for name, text in texts().items() for words in _INSTALLED.findall(text)]
    assert len(told) >= 8, "the search finds what there is"
    strangers = [(name, words) for name, words in told if re.search(r"install [^&]*(?<![/.])cleancli", words)]
    assert not strangers


@pytest.mark.parametrize("extra", MESSAGES)
def test_messages_name_what_the_extra_asks_for(extra: str) -> None:
    asked = " ".join(f"'{requirement}'" for requirement in EXTRAS[extra])
    assert f"pip install {asked}" in (ROOT / MESSAGES[extra]).read_text(encoding="utf-8")


def test_documents_name_extras_that_exist() -> None:
    named = {
        extra for text in texts().values() for extra in re.findall(r"install [^`\n]*'\.\[(\w+)\]'", text)
    }
    assert named
    assert named <= set(EXTRAS)
