"""No character of a file steers the terminal: whatever is said of it is written out (docs/commands.md)."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from cleancli.cli import progress
from cleancli.cli.main import run
from cleancli.language.diagnostics.diagnostic import Diagnostic, Source, Span, printable
from cleancli.language.diagnostics.render import render

STEERING = [*map(chr, range(32)), *map(chr, range(0x7F, 0xA0)), "\u202e", "\u2066", "\u2028", "\udcff"]
DOMAIN = """domain lamps {
  types      { lamp }
  predicates { lit(?l - lamp) }
  derived    { dark := count ?l - lamp: lit(?l) }
  actions    { switch(?l - lamp) }
  rule put_out: switch(?l) { when lit(?l)   then 1: not lit(?l) }  # a remark %s
  reward { decrease(dark) }
}
"""
PROBLEM = """problem hall {
  domain = lamps
  objects { l1 - lamp }
  init { lit(l1) }
  planner { name = "%s" }
}
"""


def steering(text: str) -> set[str]:
    return {character for character in text if character in STEERING} - {"\n"}


@pytest.mark.parametrize("character", STEERING, ids=lambda c: f"{ord(c):x}")
def test_a_character_is_written_out(character: str) -> None:
    source = Source(f"a{character}b.nid", f"one {character} two")
    span = Span(source.path, 4, 5)
    text = render([Diagnostic("E1", f"m{character}", span, f"l{character}", f"h{character}")], [source])
    assert not steering(text)
    assert printable(character) != character
    assert printable(character, keep=character) == character


def files(folder: Path, character: str) -> Iterator[tuple[str, ...]]:
    """Command lines about files that hold a control character wherever a file may hold one."""
    (folder / "lamps.nid").write_text(DOMAIN % character, encoding="utf-8")
    (folder / "hall.nid").write_text(PROBLEM % character, encoding="utf-8")
    (folder / "bad.nid").write_text(f'domain bad {{ include "x{character}.nid" }}', encoding="utf-8")
    (folder / "scene.nid").write_text(
        f'scene s {{ camera {{ calibration = "{character}" }} }}', encoding="utf-8"
    )
    yield "check", "."
    yield "show", "lamps.nid", "hall.nid"
    yield "compile", "lamps.nid", "hall.nid"
    yield "explain", "lamps.nid", "hall.nid", "switch(l1)"
    yield "plan", "lamps.nid", "hall.nid"
    yield "plan", "lamps.nid", "hall.nid", "--planner", "prada", "--samples", "10", "--json"
    yield "scene", "scene.nid"
    yield "plan", "lamps.nid", f"no{character}.nid"
    yield "explain", "lamps.nid", "hall.nid", f"switch(l{character})"


@pytest.mark.parametrize("character", ["\x1b", "\x9b", "\x7f", "\x08"], ids=lambda c: f"{ord(c):x}")
def test_commands_write_it_out(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], character: str
) -> None:
    monkeypatch.chdir(tmp_path)
    for words in files(tmp_path, character):
        run(list(words))
        printed = capsys.readouterr()
        assert not steering(printed.out + printed.err), words


def test_a_diff_is_exact_for_programs_and_written_out_for_people(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    next(files(tmp_path, "\x1b"))
    run(["fmt", "--diff", "lamps.nid"])
    assert "\x1b" in capsys.readouterr().out
    monkeypatch.setattr("sys.stdout.isatty", lambda: True)
    run(["fmt", "--diff", "lamps.nid"])
    shown = capsys.readouterr().out
    assert not steering(shown)
    assert r"remark \x1b" in shown


def test_what_takes_long_is_told_in_a_line_outside_a_terminal(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """docs/commands.md: on standard error, after seconds that may be set; what is quick tells nothing."""
    monkeypatch.setenv("CLEANCLI_PROGRESS_AFTER", "0.05")
    for seconds, told in ((0.0, ""), (0.5, "planning ...\n")):
        with progress.working("planning"):
            time.sleep(seconds)
        assert capsys.readouterr() == ("", told)
        for _ in progress.counted("planning", range(1), 1):
            time.sleep(seconds)
        assert capsys.readouterr() == ("", told)
    with progress.working("planning", quiet=True):
        time.sleep(0.2)
    monkeypatch.setenv("CLEANCLI_PROGRESS_AFTER", "inf")
    with progress.working("planning"):
        time.sleep(0.2)
    assert capsys.readouterr() == ("", "")
    for unset in ("", "soon"):
        monkeypatch.setenv("CLEANCLI_PROGRESS_AFTER", unset)
        assert progress.slow() == 2.0
    monkeypatch.delenv("CLEANCLI_PROGRESS_AFTER")
    assert progress.slow() == 2.0


def test_a_slow_plan_says_what_it_waits_for_and_keeps_its_answer_clean() -> None:
    """docs/commands.md: the line is on standard error, so that what is printed can be read by programs."""
    words = [sys.executable, "-m", "cleancli.cli.main", "plan", "cleaning", "three_areas", "--samples", "50"]
    done = [
        subprocess.run(
            words, capture_output=True, text=True, env=os.environ | {"CLEANCLI_PROGRESS_AFTER": seconds}
        )
        for seconds in ("0", "inf")
    ]
    first = "planning (the first plan by this planner also compiles it, for up to a minute) ...\n"
    assert [each.stderr for each in done] == [first, ""]
    plans = [each.stdout.partition("seconds")[0] for each in done]
    assert plans[0] == plans[1] != ""


def test_mistakes_keep_their_colours_in_a_terminal() -> None:
    source = Source("a.nid", "\x1b[31mred")
    text = render([Diagnostic("E1", "m", Span("a.nid", 0, 1))], [source], colour=True)
    assert text.count("\x1b[31m") == 2, "the title and the carets, not the text's own"
