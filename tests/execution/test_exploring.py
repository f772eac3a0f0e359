"""The strategy that explores (docs/execution.md): from a vocabulary alone, cut short, and what is refused."""

from __future__ import annotations

import io
import signal
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from cleancli.api.executions import execute_series, resume_series
from cleancli.api.series import SeriesResult
from cleancli.cli.exit_codes import ExitCode
from cleancli.cli.main import run
from cleancli.execution.events import Acted, Ended, Event
from cleancli.language.load import load_domain, read_source
from cleancli.language.model import Domain
from cleancli.learning.experience import Transition, read_experience
from cleancli.learning.exploration.explored import explored
from cleancli.learning.variation import variation
from cleancli.planning.plan import BadOption
from cleancli.recording.folder import EXPERIENCE
from cleancli.recording.journal import Planned, read_journal
from support.locked_doors import PROBLEM, RULES, VOCABULARY

ASKED: dict[str, Any] = {
    "episodes": 2,
    "seed": 4,
    "samples": 50,
    "strategy": "explore",
    "learn": True,
    "video": False,
    "known": 3,
    "max_actions": 25,
}


class Killed(BaseException):
    """Stands for a process that is gone: nobody may catch it."""


@pytest.fixture(autouse=True)
def own(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A vocabulary in the current folder, and beside it the rules that hold."""
    monkeypatch.chdir(tmp_path)
    Path("own.nid").write_text(VOCABULARY % "", encoding="utf-8")
    Path("true.nid").write_text(VOCABULARY % RULES, encoding="utf-8")
    Path("p.nid").write_text(PROBLEM, encoding="utf-8")


def carried_out(**asked: Any) -> SeriesResult:
    return execute_series("own.nid", "p.nid", **{"world": "true.nid", **ASKED, **asked})


def experience(result: SeriesResult) -> list[Transition]:
    domain = load_domain(read_source(Path("own.nid")))
    return [each for done in result.runs for each in read_experience(done.folder / EXPERIENCE, domain)]


def true() -> Domain:
    return load_domain(read_source(Path("true.nid")))


def test_rules_are_learned_from_a_vocabulary_and_then_the_goal_is_reached() -> None:
    """Each action has been done where it does something, and what its rules say is near what holds."""
    result = carried_out(episodes=3)
    done = experience(result)
    learned = explored(load_domain(read_source(Path("own.nid"))), done).domain
    assert {rule.action for rule in learned.rules} == {"push", "unlock", "bolt"}
    assert variation(learned, true(), done) < 0.1
    assert result.runs[-1].clean


def test_what_one_episode_has_shown_the_next_one_knows() -> None:
    """Where all was seen often enough, nothing is tried any more: the shortest way is taken."""
    first, *_, last = (done.actions for done in carried_out(episodes=4).runs)
    assert last < first


def test_the_same_seed_explores_the_same_and_another_one_differs(tmp_path: Path) -> None:
    runs = [
        experience(carried_out(seed=seed, runs=tmp_path / str(n), max_actions=12))
        for n, seed in enumerate((4, 4, 5))
    ]
    assert runs[0] == runs[1] != runs[2]


def test_exploring_goes_on_after_a_kill_as_if_there_was_none(tmp_path: Path) -> None:
    short: dict[str, Any] = {"max_actions": 12}
    undisturbed = experience(carried_out(runs=tmp_path / "whole", **short))
    kills: list[tuple[type[Event], int]] = [(Acted, 1), (Acted, 2), (Ended, 1)]
    for number, (kind, episode) in enumerate(kills):
        with pytest.raises(Killed):
            carried_out(runs=tmp_path / str(number), on_event=_killing(kind, episode), **short)
        (folder,) = (tmp_path / str(number)).iterdir()
        assert experience(resume_series(folder)) == undisturbed


def _killing(kind: type[Event], episode: int) -> Callable[[Event], None]:
    """Ends the process at the fifth event of a kind in an episode, or the only one."""
    seen: list[Event] = []

    def follow(event: Event) -> None:
        seen.append(event)
        ended = sum(isinstance(each, Ended) for each in seen[:-1])
        number = sum(isinstance(each, kind) for each in seen)
        if isinstance(event, kind) and ended == episode - 1 and number >= (1 if kind is Ended else 5):
            raise Killed

    return follow


def test_plans_go_by_whole_rules_that_are_learned_meanwhile() -> None:
    """A strategy that plans does nothing where it knows no rule; with structure it learns them from what it
    was told first."""
    Path("own.nid").write_text(VOCABULARY % RULES.replace("not locked(?d), not open(?d)", "not open(?d)"))
    result = carried_out(strategy="plan-1", structure=True, episodes=3)
    learned = explored(load_domain(read_source(Path("own.nid"))), experience(result)).domain
    assert len(experience(result)) > 3
    assert {rule.action for rule in learned.rules} == {"push", "unlock", "bolt"}


def demonstrated(result: SeriesResult) -> list[int]:
    """How many demonstrations each episode has had."""
    journals = (read_journal(done.folder).records for done in result.runs)
    return [sum(isinstance(r, Planned) and r.planner == "teacher" for r in records) for records in journals]


def test_a_teacher_is_asked_where_no_plan_reaches_the_goal_and_less_and_less() -> None:
    """One demonstration of each action that is needed, at most; then the goal is reached alone."""
    result = carried_out(episodes=4, teacher="true.nid", max_actions=40)
    first, *others = demonstrated(result)
    assert 1 <= first <= 3
    assert not any(others)
    assert all(done.clean for done in result.runs)


def test_a_run_with_a_teacher_goes_on_after_a_kill(tmp_path: Path) -> None:
    asked: dict[str, Any] = {"teacher": "true.nid", "max_actions": 40}
    undisturbed = experience(carried_out(runs=tmp_path / "whole", **asked))
    with pytest.raises(Killed):
        carried_out(runs=tmp_path / "cut", on_event=_killing(Acted, 1), **asked)
    (folder,) = (tmp_path / "cut").iterdir()
    Path("true.nid").unlink()
    assert experience(resume_series(folder)) == undisturbed


def toggled(runs: Path | None = None, **asked: Any) -> SeriesResult:
    """A game in which each turn of a card wins by a small chance, and else turns the card."""
    text = "domain card { predicates { up() won() } actions { turn() } %s reward { goal } }"
    rules = "rule up: turn() { when not up() then 0.95: up() 0.05: won() }"
    rules += " rule down: turn() { when up() then 0.95: not up() 0.05: won() }"
    Path("bare.nid").write_text(text % "", encoding="utf-8")
    Path("card.nid").write_text(text % rules, encoding="utf-8")
    problem = "problem q { domain = card init { } goal { won() } horizon = 8 }"
    Path("q.nid").write_text(problem, encoding="utf-8")
    given = {**ASKED, "teacher": "card.nid", "episodes": 1, "max_actions": 60, **asked}
    return execute_series("bare.nid", "q.nid", world="card.nid", runs=runs or "runs", **given)


def test_what_a_teacher_has_shown_in_a_state_is_done_again_there_unasked(tmp_path: Path) -> None:
    """There are two states to be shown what to do in, and many turns until one has won. It is remembered also
    by a run that goes on."""
    done = toggled()
    assert demonstrated(done) == [2]
    assert done.runs[0].actions > 5
    assert done.runs[0].clean
    with pytest.raises(Killed):
        toggled(tmp_path / "cut", on_event=_killing(Acted, 1))
    (folder,) = (tmp_path / "cut").iterdir()
    resumed = resume_series(folder)
    assert demonstrated(resumed) == [2]
    assert [each.actions for each in resumed.runs] == [each.actions for each in done.runs]


def test_a_person_is_asked_and_told_of_bad_input(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """The first answer is none; after a door that is locked was pushed in vain nothing more is shown."""
    monkeypatch.setattr("sys.stdin", io.StringIO("opne(a)\npush(a)\n\n"))
    words = "execute own.nid p.nid --world true.nid --strategy explore --learn --no-video --seed 4"
    assert run([*words.split(), "--teacher", "ask", "--max-actions", "30"]) == ExitCode.NOT_CLEAN
    told = "".join(capsys.readouterr())
    assert "W403" not in told, "what no rule reaches yet is what is to be learned"
    assert "no plan is believed to reach the goal; known least: push (never tried)" in told
    assert "unknown action `opne`" in told
    assert "shown: push(a)" in told
    assert "push (1 try, 0 changed something)" in told


def test_a_teacher_who_presses_ctrl_c_is_heard_at_once(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def readline(size: int = -1) -> str:
        signal.raise_signal(signal.SIGINT)
        pytest.fail("the question waits for the end of the line")

    monkeypatch.setattr("sys.stdin", typed := io.StringIO())
    monkeypatch.setattr(typed, "readline", readline)
    words = "execute own.nid p.nid --world true.nid --strategy explore --learn --no-video --seed 4"
    assert run([*words.split(), "--teacher", "ask"]) == ExitCode.INTERRUPTED
    assert "go on with: cleancli execute --resume" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("asked", "told"),
    [
        ({"learn": False}, "the strategy explore learns rules while it works: ask for learning"),
        ({"learn": False}, "`--learn`"),
        ({"world": None}, "the domain has no rules, so that nothing can happen"),
        ({"world": None, "strategy": "plan-1", "structure": True}, "the domain has no rules"),
        ({"strategy": "plan-1", "learn": False, "structure": True}, "ask for learning as well"),
        ({"strategy": "plan-1", "teacher": "true.nid"}, "plan-1 asks nobody"),
        ({"optimism": "rmax"}, "the strategy explore hopes"),
        ({"write": True}, "cleancli learn --structure DOMAIN RUNS --write"),
    ],
)
def test_what_makes_no_sense_is_refused(asked: dict[str, Any], told: str) -> None:
    with pytest.raises(BadOption, match=told):
        carried_out(**asked)
    assert not Path("runs").exists() or not any(Path("runs").iterdir())
