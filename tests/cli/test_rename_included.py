"""A rename goes through all files that a domain includes, and writes all of them or none."""

from __future__ import annotations

from pathlib import Path

import pytest

from cleancli.cli.main import run

TEXTS = {
    "tables.nid": """domain tables {
  include "left.nid"
  include "parts/right.nid"
  rule wipe_it: wipe(?a) {  # dirt
    when dirt(?a)
    then 0.9: not dirt(?a)
         0.1: nothing
  }
  reward { decrease(dirty_areas) }
}
""",
    "left.nid": 'domain left {\n  include "parts/base.nid"\n  actions { wipe(?a - area) }\n}\n',
    "parts/right.nid": """domain right {
  include "../parts/base.nid"
  derived { dirty_areas := count ?a - area: dirt(?a) }
}
""",
    "parts/base.nid": "domain base {\r\n  types { area }\r\n  predicates { dirt(?a - area) }\r\n}\r\n",
    "two.nid": "problem two {\n  domain = tables\n  objects { a1 - area }\n  init { dirt(a1) }\n}\n",
    "other.nid": """domain other {
  include "parts/base.nid"
  derived { n := count ?a - area: dirt(?a) }
}
""",
}
"""A diamond of two levels: `base` is included by `left` and `right`; `other` is not asked for."""
PLACES = {"tables.nid": 2, "parts/right.nid": 1, "parts/base.nid": 1, "two.nid": 1}
WORDS = ["rename", "dirt", "dust", "--domain", "tables.nid", "two.nid"]


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    place = tmp_path / "here"
    (place / "parts").mkdir(parents=True)
    for name, text in TEXTS.items():
        (place / name).write_bytes(text.encode("utf-8"))
    monkeypatch.chdir(place)
    return place


def texts(folder: Path) -> dict[str, str]:
    return {name: (folder / name).read_bytes().decode("utf-8") for name in TEXTS}


def renamed() -> dict[str, str]:
    """What all files should be."""
    return {name: text.replace("dirt(", "dust(") if name in PLACES else text for name, text in TEXTS.items()}


def test_all_included_files_are_shown_and_then_written(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(WORDS) == 0
    told = capsys.readouterr()
    shown = {line.split()[1] for line in told.out.splitlines() if line.startswith("--- ")}
    assert {str(Path(name).resolve().relative_to(folder)) for name in shown} == set(PLACES)
    assert told.err == f"{sum(PLACES.values())} places in {len(PLACES)} of 5 files\n"
    assert texts(folder) == TEXTS
    assert run([*WORDS, "--write"]) == 0
    assert texts(folder) == renamed()
    assert run(["check", "two.nid"]) == 0


def test_a_file_that_is_named_and_included_is_renamed_once(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (folder / "linked.nid").symlink_to("parts/base.nid")
    named = ["parts/base.nid", "./parts/../left.nid", "linked.nid", "./two.nid"]
    assert run([*WORDS, *named, "--write"]) == 0
    assert f"in {len(PLACES)} of 5 files" in capsys.readouterr().out
    assert texts(folder) == renamed()
    assert (folder / "linked.nid").is_symlink()


def test_another_domain_cannot_be_named(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run([*WORDS, "other.nid", "--write"]) == 1
    assert "E106" in capsys.readouterr().err
    assert texts(folder) == TEXTS


def test_what_is_read_only_keeps_all_from_being_written(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (folder / "parts" / "base.nid").chmod(0o444)
    before = sorted(folder.rglob("*"))
    assert run([*WORDS, "--write"]) == 5
    error = capsys.readouterr().err
    assert "read-only, and so nothing was written" in error
    assert "base.nid" in error
    assert texts(folder) == TEXTS
    assert sorted(folder.rglob("*")) == before


def test_a_name_that_is_taken_in_an_included_file(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["rename", "dirt", "dirty_areas", *WORDS[3:], "--write"]) == 1
    assert "parts/right.nid:3:13: error[E803]" in capsys.readouterr().err
    assert texts(folder) == TEXTS


def test_files_from_outside_must_be_allowed(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (folder / "parts" / "base.nid").rename(folder.parent / "base.nid")
    for name, text in TEXTS.items():
        if name not in ("parts/base.nid", "other.nid"):
            up = "../../base.nid" if name.startswith("parts") else "../base.nid"
            changed = text.replace("../parts/base.nid", up).replace('"parts/base.nid', f'"{up}')
            (folder / name).write_text(changed, encoding="utf-8")
    assert run([*WORDS, "--write"]) == 1
    assert "left.nid:2:3: error[E109]" in capsys.readouterr().err
    outside = folder.parent / "base.nid"
    assert outside.read_bytes().decode("utf-8") == TEXTS["parts/base.nid"]
    assert run(["--include-outside", *WORDS, "--write"]) == 0
    assert outside.read_bytes().decode("utf-8") == renamed()["parts/base.nid"]
    assert run(["--include-outside", "check", "tables.nid"]) == 0


def test_a_missing_file_is_told_before_a_missing_name(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (folder / "parts" / "base.nid").unlink()
    assert run([*WORDS, "--write"]) == 1
    error = capsys.readouterr().err
    assert "E001" in error
    assert "E801" not in error
