"""Learning while working: what plans go by, what is recorded, and what going on takes (docs/learning.md)."""

from __future__ import annotations

import shutil
from collections import Counter
from pathlib import Path
from typing import Any

import pytest

from cleancli.api import series
from cleancli.api.executions import execute, execute_series, resume
from cleancli.api.lessons import learn
from cleancli.cli.main import run
from cleancli.execution import believed
from cleancli.execution.believed import lesson_of
from cleancli.execution.episode_state import EpisodeState
from cleancli.execution.events import Acted, Checkpoint, Decided, Event, Learned
from cleancli.execution.loop import clean
from cleancli.execution.session import symbolic_session
from cleancli.execution.setup import EpisodeOptions
from cleancli.language.diagnostics.diagnostic import Source
from cleancli.language.load import load_domain, load_problem
from cleancli.language.model import Domain
from cleancli.learning.evidence import Evidence
from cleancli.learning.gathered import whole
from cleancli.learning.learn import Lesson
from cleancli.learning.match import Fit, Match
from cleancli.learning.method import Method
from cleancli.recording import checkpoint
from cleancli.recording.fitting import check_fits
from cleancli.recording.folder import EXPERIENCE
from cleancli.recording.journal import Learned as LearnedEntry
from cleancli.recording.journal import Resumed, Started, read_journal
from support.doors import PULLED

TRUE_TEXT = PULLED % "0.05"
BELIEVED, TRUE = (load_domain(Source("doors.nid", PULLED % chance)) for chance in ("0.8", "0.05"))
DOORS = "problem p { domain = doors objects { a b c - door } init { } }"
PROBLEM = load_problem(Source("p.nid", DOORS), BELIEVED)


def events(learning: Method | None, most: int = 60) -> list[Event]:
    """An episode in a world where pushing hardly ever opens a door."""
    asked = EpisodeOptions(strategy="plan-1", samples=200, seed=3, max_actions=most, learning=learning)
    session = symbolic_session(BELIEVED, PROBLEM, asked, acting=TRUE)
    return list(clean(session.setup, session.cell))


def actions(found: list[Event]) -> list[str]:
    return [event.move.action for event in found if isinstance(event, Acted)]


def test_plans_go_by_what_was_learned() -> None:
    """Pushing is believed to be best, until it has failed; who does not learn goes on pushing."""
    assert actions(events(None, most=4)) == ["push"] * 4
    found = actions(events(Method("likelihood"), most=4))
    assert (found[0], found[-1]) == ("push", "pull")


def test_every_action_is_learned_from_and_told() -> None:
    found = events(Method())
    acted = [event for event in found if isinstance(event, Acted)]
    learned = [event for event in found if isinstance(event, Learned)]
    assert len(learned) == len(acted)
    last = {each.rule: sum(each.seen) for each in learned[-1].lesson.rules}
    done = Counter(event.move.action for event in acted)
    assert last == {number: done[name] for number, name in enumerate(("push", "pull")) if done[name]}
    chance = learned[-1].domain.rules[0].outcomes[0].probability
    assert chance < BELIEVED.rules[0].outcomes[0].probability
    plans = [event.plan for event in found if isinstance(event, Decided)]
    assert len(plans) > 1


def test_an_episode_goes_on_from_what_it_had_learned(tmp_path: Path) -> None:
    states = [event.state for event in events(Method()) if isinstance(event, Checkpoint)]
    state = states[-1]
    assert len(state.evidence.order) == state.actions
    for name in ("journal.jsonl", EXPERIENCE):
        (tmp_path / name).touch()
    checkpoint.save(tmp_path, state, {})
    read = checkpoint.read(tmp_path, next((tmp_path / "state").iterdir())).episode
    assert read.evidence == state.evidence
    check_fits(read, BELIEVED, PROBLEM.objects)


def test_what_is_learned_is_worked_out_once_after_each_action(monkeypatch: pytest.MonkeyPatch) -> None:
    worked_out: list[Evidence] = []

    def counted(domain: Domain, evidence: Evidence, method: Method) -> Lesson:
        worked_out.append(evidence)
        return lesson_of(domain, evidence, method)

    monkeypatch.setattr(believed, "lesson_of", counted)
    found = events(Method(), most=5)
    assert len(worked_out) == len(actions(found)) > 1
    assert len(set(worked_out)) == len(worked_out)


def test_a_run_that_goes_on_expects_what_was_learned_before(tmp_path: Path) -> None:
    """Its next action is explained by that, and not by what the text says."""
    (tmp_path / "own.nid").write_text(PULLED % "0.8", encoding="utf-8")
    seen: list[Event] = []

    def stopping(event: Event) -> None:
        seen.append(event)
        if len(actions(seen)) == 2 and isinstance(event, Checkpoint):
            raise KeyboardInterrupt

    asked: dict[str, Any] = {"learn": True, "estimator": "likelihood", "strategy": "plan-1", "samples": 200}
    asked |= {"seed": 3, "runs": tmp_path, "world": TRUE_TEXT}
    with pytest.raises(KeyboardInterrupt):
        execute(tmp_path / "own.nid", DOORS, on_event=stopping, **asked)
    (folder,) = (path.parent for path in tmp_path.glob("*/run.json"))
    resume(folder)
    records = read_journal(folder).records
    (resumed,) = (number for number, record in enumerate(records) if isinstance(record, Resumed))
    before = [record for record in records[:resumed] if isinstance(record, LearnedEntry)]
    chances: dict[str | None, tuple[float, ...]]
    chances = {rule.name: tuple(float(o.probability) for o in rule.outcomes) for rule in BELIEVED.rules}
    by_text = chances["pushed"]
    chances |= {entry.rule: entry.probabilities for record in before for entry in record.rules}
    expected = next(record.expected for record in records[resumed:] if isinstance(record, Started))
    assert tuple(outcome.probability for outcome in expected.outcomes) == chances[expected.rule]
    assert chances["pushed"] != by_text


@pytest.mark.parametrize(
    "evidence",
    [
        Evidence((Match(7, (Fit(), None)),), (0,)),
        Evidence((Match(-1, (Fit(), None)),), (0,)),
        Evidence((Match(0, (Fit(),)),), (0,)),
        Evidence((Match(None, (Fit(), None, None)),), (0,)),
        Evidence((Match(0, (Fit(), None)),), (0, 1)),
        Evidence((Match(0, (Fit(), None)),), (-1,)),
        Evidence((Match(0, (Fit(misses=-2), None)),), (0,)),
        Evidence((Match(0, (Fit(quiet=10**12), None)),), (0,)),
        Evidence(times=(("lift", (5800,)),)),
        Evidence(times=(("push", (-1,)),)),
        Evidence(times=(("push", (10**15,)),)),
    ],
)
def test_evidence_that_no_episode_can_have_is_refused(evidence: Evidence) -> None:
    with pytest.raises(ValueError, match="learned"):
        check_fits(EpisodeState(evidence=evidence), BELIEVED, PROBLEM.objects)


@pytest.mark.parametrize("option", ["", " --forgetting 0.2"])
def test_a_series_writes_what_learning_offline_from_its_records_does(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, option: str
) -> None:
    """Digit for digit, and each episode goes on from what those before have learned."""
    monkeypatch.chdir(tmp_path)
    own, other = tmp_path / "own.nid", tmp_path / "other.nid"
    for path in (own, other):
        path.write_text(PULLED % "0.8", encoding="utf-8")
    (tmp_path / "true.nid").write_text(PULLED % "0.05", encoding="utf-8")
    (tmp_path / "p.nid").write_text(DOORS)
    words = (
        "execute own.nid p.nid --world true.nid --learn --episodes 3 --write --quiet --seed 4 --samples 200"
    )
    assert run([*words.split(), *option.split()]) in {0, 3}
    (folder,) = Path("runs").iterdir()
    assert folder.name == "p-seed4-series-001"
    runs = sorted(path for path in folder.iterdir() if path.is_dir())
    assert [folder.name for folder in runs] == ["p-seed4-001", "p-seed5-001", "p-seed6-001"]
    learn(other, *runs, forgetting=0.2 if option else None, write=True)
    assert own.read_text() == other.read_text()
    assert "[prior 0.8, seen " in own.read_text()
    first, last = (told(folder) for folder in (runs[0], runs[-1]))
    assert sum(first[0].rules[0].seen) == 1
    assert sum(last[-1].rules[0].seen) > 1
    assert ("forgetting = 0.2" in own.read_text()) == bool(option)


def test_the_record_of_each_episode_is_hashed_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """And not again after each of those that follow."""
    hashed: list[Path] = []

    def counted(path: Path) -> tuple[int, str]:
        hashed.append(path)
        return whole(path)

    monkeypatch.setattr(series, "whole", counted)
    result = execute_series(
        PULLED % "1", DOORS, episodes=3, learn=True, seed=1, samples=50, runs=tmp_path, video=False
    )
    assert hashed == [run.folder / EXPERIENCE for run in result.runs]
    assert [each.transitions for each in result.experience] == [run.actions for run in result.runs]


def told(folder: Path) -> list[LearnedEntry]:
    """What a run's journal says was learned."""
    return [record for record in read_journal(folder).records if isinstance(record, LearnedEntry)]


def test_episodes_in_which_the_same_happens_all_count(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """And a copy of one of them counts once."""
    monkeypatch.chdir(tmp_path)
    certain = (PULLED % "1").replace("open(?d) rest: nothing", "open(?d)", 1)
    (tmp_path / "own.nid").write_text(certain, encoding="utf-8")
    (tmp_path / "p.nid").write_text(DOORS)
    assert (
        run(
            ["execute", "own.nid", "p.nid", "--learn", "--episodes", "3", "--write", "--quiet", "--seed", "1"]
        )
        == 0
    )
    assert "[prior 1, seen 9]" in (tmp_path / "own.nid").read_text()
    shutil.copytree("runs/p-seed1-series-001/p-seed2-001", "runs/copy")
    (tmp_path / "own.nid").write_text(certain, encoding="utf-8")
    result = learn("own.nid", "runs")
    assert result.rules[0].examples == 9
    assert any("given twice" in note for note in result.notes)


def test_what_the_text_has_counted_counts_on(tmp_path: Path) -> None:
    path = tmp_path / "own.nid"
    counted = (PULLED % "0.8").replace("0.8:", "0.1 [prior 0.8, seen 2]:")
    path.write_text(counted.replace("rest: n", "rest [seen 30]: n", 1), encoding="utf-8")
    result = execute(path, DOORS, learn=True, seed=1, runs=tmp_path / "runs", video=False)
    seen = {entry.rule: sum(entry.seen) for record in told(result.folder) for entry in record.rules}
    assert seen["pushed"] >= 32
    assert sum(seen.values()) == 32 + result.actions
