"""Commands that read and write texts: check, fmt, rename, init."""

from __future__ import annotations

import io
import json
import os
import shlex
import stat
import sys
from pathlib import Path

import pytest

from cleancli.cli.echo import wants_colour
from cleancli.cli.files import RECORDS, below
from cleancli.cli.main import run
from cleancli.experiment.store import LINES
from cleancli.language.find import find
from cleancli.language.printing.formatter import layout
from cleancli.recording.folder import RUN
from cleancli.recording.series import SERIES

DOMAIN = find("cleaning", "domains").read_text(encoding="utf-8")
PROBLEM = find("three_areas", "problems").read_text(encoding="utf-8")
UNTIDY = PROBLEM.replace("{\n", "{ # note\n").replace("\n  ", "\n\t").replace("\n", "\r\n")
BAD = PROBLEM.replace("domain ", "domain domain ")


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "deep").mkdir()
    (tmp_path / "cleaning.nid").write_text(DOMAIN, encoding="utf-8")
    (tmp_path / "deep" / "three.nid").write_text(PROBLEM, encoding="utf-8")
    return tmp_path


class _Stdin:
    """What a process has for standard input, as far as it is read here."""

    def __init__(self, text: str) -> None:
        self.buffer = io.BytesIO(text.encode("utf-8"))


# ---- check


def test_check_takes_folders_and_standard_input(
    folder: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    assert run(["check", "."]) == 0
    assert capsys.readouterr().out == "0 mistakes in 2 files\n"
    monkeypatch.setattr(sys, "stdin", _Stdin(BAD))
    assert run(["check", ".", "-"]) == 1
    assert "<stdin>:4:10: error[E104]" in capsys.readouterr().out
    monkeypatch.setattr(sys, "stdin", _Stdin(PROBLEM))
    assert run(["check", "-"]) == 0


def test_copies_in_the_folders_of_runs_and_studies_are_passed_over(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """docs/commands.md; they name files that do not lie beside them. Who names such a folder means it."""
    assert set(RECORDS) == {RUN, SERIES, LINES}
    for record in RECORDS:
        copies = folder / "deep" / record.split(".")[0] / "files"
        copies.mkdir(parents=True)
        (copies / "copy.nid").write_text(BAD, encoding="utf-8")
        (copies.parent / record).write_text("", encoding="utf-8")
    for command in ("check", "fmt --check"):
        run([*command.split(), "."])
        told = capsys.readouterr()
        assert "note: passed over 3 copies of files in folders of runs and studies\n" in told.err
        assert "copy.nid" not in told.out + told.err
    assert run(["check", "deep/run"]) == 1
    assert "copy.nid" in capsys.readouterr().out


def test_the_files_of_a_folder_come_in_the_order_of_their_names(folder: Path) -> None:
    """Whatever order the disk has them in."""
    (folder / "many").mkdir()
    names = [f"{letter}.nid" for letter in "gbkahdcijfel"]
    for name in names:
        (folder / "many" / name).touch()
    assert [path.name for path in below(folder / "many")] == sorted(names)


def test_check_of_a_folder_without_files(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (folder / "empty" / ".git").mkdir(parents=True)
    (folder / "empty" / ".git" / "x.nid").touch()
    assert run(["check", "empty"]) == 1
    assert "error[E002]: `empty` is a folder without .nid files" in capsys.readouterr().out


@pytest.mark.parametrize("option", [["--format", "json"], ["--json"]])
def test_check_as_data(option: list[str], folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (folder / "bad.nid").write_text(BAD, encoding="utf-8")
    assert run(["check", "bad.nid", *option]) == 1
    (entry,) = json.loads(capsys.readouterr().out)
    assert (entry["code"], entry["path"], entry["line"]) == ("E104", "bad.nid", 4)


def test_colour_only_where_it_is_wanted(monkeypatch: pytest.MonkeyPatch) -> None:
    class Terminal(io.StringIO):
        def isatty(self) -> bool:
            return True

    monkeypatch.setenv("TERM", "xterm")
    monkeypatch.delenv("NO_COLOR", raising=False)
    assert wants_colour(Terminal())
    assert not wants_colour(io.StringIO())
    monkeypatch.setenv("NO_COLOR", "1")
    assert not wants_colour(Terminal())
    monkeypatch.setenv("NO_COLOR", "")
    monkeypatch.setenv("TERM", "dumb")
    assert not wants_colour(Terminal())


@pytest.mark.parametrize("out", [True, False])
@pytest.mark.parametrize("err", [True, False])
@pytest.mark.parametrize(
    "words", ["check bad.nid", "plan cleaning bad.nid", "fmt bad.nid", "explain cleaning x y"]
)
def test_what_goes_to_a_terminal_is_coloured_and_nothing_else(
    words: str,
    out: bool,
    err: bool,
    folder: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Whichever of the two streams is one."""
    monkeypatch.setenv("TERM", "xterm")
    monkeypatch.delenv("NO_COLOR", raising=False)
    monkeypatch.setattr("sys.stdout.isatty", lambda: out)
    monkeypatch.setattr("sys.stderr.isatty", lambda: err)
    (folder / "bad.nid").write_text(BAD, encoding="utf-8")
    assert run(words.split()) == 1
    said = capsys.readouterr()
    for text, is_terminal in ((said.out, out), (said.err, err)):
        assert ("\x1b[" in text) == (is_terminal and "error" in text)
    assert "error" in said.out + said.err


# ---- fmt


def test_fmt_changes_only_what_needs_it(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    untidy, before = folder / "deep" / "untidy.nid", (folder / "cleaning.nid").stat().st_mtime_ns
    untidy.write_bytes(UNTIDY.encode())
    untidy.chmod(0o600)
    assert run(["fmt", "--check", "."]) == 1
    assert capsys.readouterr().out == "would format deep/untidy.nid\nfiles: 1 would change, 2 unchanged\n"
    assert run(["fmt", "--diff", "."]) == 0
    assert "--- deep/untidy.nid" in capsys.readouterr().out
    assert untidy.read_bytes() == UNTIDY.encode()
    assert run(["fmt", "."]) == 0
    assert capsys.readouterr().out == "formatted deep/untidy.nid\nfiles: 1 changed, 2 unchanged\n"
    assert untidy.read_bytes() == layout(UNTIDY).encode()
    assert b"\r\n" in untidy.read_bytes()
    assert stat.S_IMODE(untidy.stat().st_mode) == 0o600
    assert (folder / "cleaning.nid").stat().st_mtime_ns == before
    assert run(["fmt", "--check", "."]) == 0


def test_fmt_leaves_a_file_with_mistakes(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (folder / "bad.nid").write_text(BAD, encoding="utf-8")
    (folder / "untidy.nid").write_bytes(UNTIDY.encode())
    assert run(["fmt", "bad.nid", "untidy.nid"]) == 1
    told = capsys.readouterr()
    assert "bad.nid:4:10: error[E104]" in told.err
    assert told.out == "formatted untidy.nid\nfiles: 1 changed, 0 unchanged, 1 left alone for mistakes\n"
    assert (folder / "bad.nid").read_text(encoding="utf-8") == BAD


def test_fmt_as_a_filter(
    folder: Path, capfdbinary: pytest.CaptureFixture[bytes], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sys, "stdin", _Stdin(UNTIDY))
    assert run(["fmt", "-"]) == 0
    told = capfdbinary.readouterr()
    assert told.out == layout(UNTIDY).encode()
    assert told.err == b""
    monkeypatch.setattr(sys, "stdin", _Stdin(BAD))
    assert run(["fmt", "-"]) == 1
    assert capfdbinary.readouterr().out == b""


# ---- rename


def test_rename_shows_and_then_writes(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    words = ["rename", "dirt", "dust", "--domain", "cleaning.nid", "deep/three.nid"]
    assert run(words) == 0
    told = capsys.readouterr()
    assert "-    dirt(a1), size(a1) = small\n" in told.out
    assert "+    dust(a1), size(a1) = small\n" in told.out
    assert told.err.endswith("in 2 of 2 files\n")
    assert (folder / "cleaning.nid").read_text(encoding="utf-8") == DOMAIN
    assert run([*words, "--write"]) == 0
    assert (folder / "deep" / "three.nid").read_text(encoding="utf-8") == PROBLEM.replace("dirt(", "dust(")
    assert run(["show", "cleaning.nid", "deep/three.nid"]) == 0
    assert run(["rename", "dust", "dirt", "--write", *words[3:]]) == 0
    assert (folder / "cleaning.nid").read_text(encoding="utf-8") == DOMAIN


def test_rename_checks_all_before_it_writes(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (folder / "broken.nid").write_text(PROBLEM.replace("dirt(a1)", "drit(a1)"), encoding="utf-8")
    assert run(["rename", "dirt", "dust", "--domain", "cleaning.nid", "broken.nid", "--write"]) == 1
    assert "broken.nid:7:5: error[E203]" in capsys.readouterr().err
    assert (folder / "cleaning.nid").read_text(encoding="utf-8") == DOMAIN


def test_rename_leaves_shipped_files(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    os.remove("cleaning.nid")
    assert run(["rename", "dirt", "dust", "--domain", "cleaning"]) == 0
    assert run(["rename", "dirt", "dust", "--domain", "cleaning", "--write"]) == 2
    assert "copy" in capsys.readouterr().err


# ---- init


@pytest.mark.parametrize(("about", "action"), [([], "wipe("), (["--about", "delivery"], "drive(")])
def test_what_init_writes_is_right(
    about: list[str], action: str, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(["init", "new/start", *about]) == 0
    told = capsys.readouterr().out
    commands = [shlex.split(line) for line in told.splitlines() if line.startswith("  cleancli")]
    assert len(commands) == 3
    for _, *words in commands:
        assert run(words) == 0
    assert run(["fmt", "--check", "new"]) == 0
    shown = capsys.readouterr().out
    assert "0 mistakes in 2 files" in shown
    assert action in shown


def test_init_never_replaces(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (folder / "two_stains.nid").write_text("mine", encoding="utf-8")
    assert run(["init"]) == 1
    assert "error[E006]: `two_stains.nid` already exists" in capsys.readouterr().err
    assert (folder / "two_stains.nid").read_text(encoding="utf-8") == "mine"
    assert not (folder / "wiping.nid").exists()
