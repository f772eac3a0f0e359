"""`--objective time` asks for durations, in every command that takes it."""

from __future__ import annotations

from pathlib import Path

import pytest

from cleancli.cli.main import run

DOMAIN = """domain d {
  types { area }
  predicates { dirt(?a - area) }
  derived { dirty := count ?a - area: dirt(?a) }
  actions { wipe(?a - area)%s  rub(?a - area)%s }
  rule wiped: wipe(?a) { when dirt(?a) then 0.9: not dirt(?a) rest: nothing }
  rule rubbed: rub(?a) { when dirt(?a) then 0.8: not dirt(?a) rest: nothing }
  reward { decrease(dirty) }
}
"""
PROBLEM = "problem p { domain = d  objects { a b - area }  init { dirt(a), dirt(b) } }\n"
LASTS = " [duration = 2 s]"
COMMANDS = {
    "plan": ("plan",),
    "simulate": ("simulate", "--episodes", "1"),
    "execute": ("execute", "--max-actions", "1", "--quiet"),
}


@pytest.fixture
def files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "p.nid").write_text(PROBLEM)
    return tmp_path


def asked(command: str, files: Path, durations: tuple[str, str], *more: str) -> int:
    (files / "d.nid").write_text(DOMAIN % durations)
    name, *options = COMMANDS[command]
    return run([name, "d.nid", "p.nid", *options, *more])


@pytest.mark.parametrize("command", COMMANDS)
def test_actions_without_a_duration_are_named(
    command: str, files: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert asked(command, files, (LASTS, ""), "--objective", "time") == 1
    told = capsys.readouterr().err
    column = (DOMAIN % (LASTS, "")).splitlines()[4].index("rub") + 1
    assert told.startswith(f"d.nid:5:{column}: error[E902]: time is to discount, but `rub` has no duration\n")
    assert "`wipe`" not in told
    assert not (files / "runs").exists()
