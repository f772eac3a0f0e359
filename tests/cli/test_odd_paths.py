"""Paths of bytes that are no text or that lead to the wrong kind of thing, and numbers that no limit can be,
through the commands that take them."""

from __future__ import annotations

import json
import os
from pathlib import Path

import click
import pytest

from cleancli.cli.main import cli, run

DOMAIN = """domain lamps {
  types { lamp }
  predicates { lit(?l - lamp) }
  derived { dark := count ?l - lamp: not lit(?l) }
  actions { switch(?l - lamp) }
  rule s: switch(?l) { when not lit(?l) then 0.9: lit(?l) 0.1: nothing }
  reward { decrease(dark) }
}
"""
PROBLEM = "problem evening { domain = lamps objects { a b - lamp } }\n"


@pytest.fixture
def odd(tmp_path: Path) -> Path:
    """A folder whose name is no UTF-8, with a domain and a problem in it."""
    folder = Path(os.fsdecode(os.fsencode(tmp_path) + b"/g\xff"))
    try:
        folder.mkdir()
    except OSError:
        pytest.skip("this disk takes no such names")
    (folder / "lamps.nid").write_text(DOMAIN)
    (folder / "evening.nid").write_text(PROBLEM)
    (folder / "bad.nid").write_text("domain d { typos { a } reward { goal } }")
    return folder


def test_a_run_of_files_below_an_odd_folder_is_recorded_and_reported(odd: Path) -> None:
    words = [str(odd / "lamps.nid"), str(odd / "evening.nid"), "--seed", "1", "--quiet"]
    assert run(["execute", *words, "--runs", str(odd / "r\udcff")]) == 0
    (folder,) = (odd / "r\udcff").iterdir()
    assert r"g\xff/lamps.nid" in json.loads((folder / "run.json").read_text())["files"][0]["path"]
    assert run(["report", str(folder)]) == 0
    assert run(["learn", str(odd / "lamps.nid"), str(folder)]) == 0
    renamed = folder.rename(odd / "one\udcff")
    assert run(["report", str(renamed)]) == 0
    assert r"one\xff" in (renamed / "report.html").read_text(encoding="utf-8")


@pytest.mark.parametrize("form", ["text", "json", "sarif"])
def test_mistakes_below_an_odd_folder_are_told_in_every_format(
    odd: Path, form: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(["check", "--format", form, str(odd / "bad.nid")]) == 1
    printed = capsys.readouterr()
    assert "typos" in printed.out + printed.err


@pytest.mark.parametrize("command", ["fmt", "show", "plan", "simulate", "explain", "compile"])
def test_commands_take_odd_paths(odd: Path, command: str) -> None:
    files = (
        [str(odd / "lamps.nid")] if command == "fmt" else [str(odd / "lamps.nid"), str(odd / "evening.nid")]
    )
    more = {"explain": ["switch(a)"], "simulate": ["--episodes", "2"]}.get(command, [])
    assert run([command, *files, *more]) == 0


@pytest.mark.parametrize(
    "words",
    [
        ("--max-seconds", "inf"),
        ("--max-seconds", "nan"),
        ("--max-seconds", "1e12"),
        ("--max-actions", "2000000000"),
        ("--samples", "2000000000"),
        ("--known", "2000000000"),
    ],
)
def test_limits_that_no_record_could_hold_are_no_options(tmp_path: Path, words: tuple[str, str]) -> None:
    (tmp_path / "lamps.nid").write_text(DOMAIN)
    (tmp_path / "evening.nid").write_text(PROBLEM)
    files = [str(tmp_path / "lamps.nid"), str(tmp_path / "evening.nid")]
    assert run(["execute", *files, "--runs", str(tmp_path / "runs"), *words]) == 2
    assert not (tmp_path / "runs").exists()


def test_what_is_left_out_of_many_files_is_told_once(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for number in range(130):
        (tmp_path / f"bad{number}.nid").write_text("domain d { typos { a } reward { goal } }")
    assert run(["fmt", "--check", str(tmp_path)]) == 1
    printed = capsys.readouterr()
    assert (printed.out + printed.err).count("`cleancli check --all`") == 1


FILES_AND_FOLDERS = {
    "file": (
        ("plan", "--plot"),
        ("report", "--html"),
        ("scene", "--out"),
        ("scene", "--reach"),
        ("calibrate", "--out"),
        ("perceive", "--out"),
        ("perceive", "--drawn"),
        ("perceive", "--rrd"),
        ("execute", "--rrd"),
        ("act", "--plot"),
    ),
    "folder": (
        ("init", "folder"),
        ("execute", "--resume"),
        ("perceive", "--save-frames"),
        ("convert", "--out"),
    ),
}


@pytest.mark.parametrize("kind", FILES_AND_FOLDERS)
def test_no_folder_is_written_to_as_a_file_and_no_file_is_a_folder(kind: str, tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    (tmp_path / "folder").mkdir()
    for name, option in FILES_AND_FOLDERS[kind]:
        command = cli.get_command(click.Context(cli), name)
        assert command is not None
        (parameter,) = (each for each in command.params if option in each.opts)
        assert parameter.type.convert(str(tmp_path / kind), parameter, None) == tmp_path / kind
        for other in {"file", "folder"} - {kind}:
            with pytest.raises(click.BadParameter, match=f"is a {other}|is a directory"):
                parameter.type.convert(str(tmp_path / other), parameter, None)
