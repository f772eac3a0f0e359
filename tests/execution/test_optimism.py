"""R-MAX: what plans hope of rules that are not known yet (docs/learning.md)."""

from __future__ import annotations

import json
from collections import Counter
from fractions import Fraction
from functools import partial
from pathlib import Path

import pytest

from cleancli.api.executions import execute, resume
from cleancli.cli.main import run
from cleancli.execution.events import Acted, Learned
from cleancli.execution.loop import clean
from cleancli.execution.session import symbolic_session
from cleancli.execution.setup import EpisodeOptions
from cleancli.language.diagnostics.diagnostic import Source
from cleancli.language.load import load_domain, load_problem
from cleancli.language.model import Domain
from cleancli.learning.method import Method
from cleancli.learning.optimism import most, optimistic
from cleancli.recording.journal import Acted as ActedEntry
from cleancli.recording.journal import read_journal

TEXT = """domain doors {
  types { door }
  predicates { open(?d - door) }
  derived { shut := count ?d - door: not open(?d) }
  actions { push(?d - door) [duration = 1 s] lift(?d - door) [duration = 2 s] }
  rule pushed: push(?d) { when not open(?d) then 0.6 [fixed]: open(?d) rest: nothing }
  rule lifted: lift(?d) { when not open(?d) then %s: open(?d) rest: nothing }
  reward { decrease(shut) }
}"""
NAMES = "abcdefghijkl"
DOORS = f"problem p {{ domain = doors objects {{ {' '.join(NAMES)} - door }} init {{ }} }}"
KNOWN = 6


def doors(chance: str) -> Domain:
    return load_domain(Source("doors.nid", TEXT % chance))


def episode(
    prior: str, true: str, optimism: str, planner: str | None = None, by_time: bool = False
) -> tuple[list[str], Domain]:
    """The actions of an episode, and what was believed in its end."""
    believed = doors(prior)
    asked = EpisodeOptions(
        "plan-1",
        planner,
        samples=200,
        seed=3,
        by_time=by_time,
        known=KNOWN,
        learning=Method("m", 1.0),
        optimism=optimism,
    )
    problem = load_problem(Source("p.nid", DOORS), believed)
    session = symbolic_session(believed, problem, asked, acting=doors(true))
    found = list(clean(session.setup, session.cell))
    learned = [event.domain for event in found if isinstance(event, Learned)]
    return [event.move.action for event in found if isinstance(event, Acted)], learned[-1]


@pytest.mark.parametrize("planner", ["prada+", "likeliest"])
def test_a_good_action_that_is_thought_bad_is_found(planner: str) -> None:
    """Without optimism it is never tried; with it as often as it takes to know it, and then as it is good."""
    assert set(episode("0.1", "1", "prior", planner)[0]) == {"push"}
    actions, learned = episode("0.1", "1", "rmax", planner)
    assert actions == ["lift"] * len(NAMES)
    assert learned.rules[1].outcomes[0].probability > Fraction(9, 10)


@pytest.mark.parametrize("planner", ["prada+", "likeliest"])
def test_an_action_that_turns_out_bad_is_left(planner: str) -> None:
    actions, learned = episode("0.5", "0.01", "rmax", planner)
    assert Counter(actions)["lift"] == KNOWN
    assert set(actions[KNOWN:]) == {"push"}
    assert learned.rules[1].outcomes[0].probability < Fraction(1, 10)


def test_by_time_what_takes_longer_is_tried_as_often() -> None:
    actions, _ = episode("0.5", "0.01", "rmax", by_time=True)
    assert Counter(actions)["lift"] == KNOWN


def test_no_number_that_is_learned_changes_by_hope() -> None:
    """What was seen is all that counts: of twelve doors that lifting opened, twelve."""
    learned = episode("0.1", "1", "rmax")[1].rules[1].outcomes[0].probability
    assert learned == pytest.approx((12 + 0.1) / 13, abs=1e-4)


REWARDS = """domain pay {
  types { box }
  predicates { full(?b - box)  near(?b ?c - box) }
  derived { boxes := count ?b - box: full(?b)  pairs := count ?b ?c - box: near(?b, ?c) }
  actions { fill(?b - box) [cost = 2]  rest_a_while() }
  rule filled: fill(?b) { when not full(?b) then 0.5: full(?b) rest: nothing }
  rule joined: rest_a_while() { then 0.5: forall ?b ?c - box: full(?b) => near(?b, ?c) rest: nothing }
  reward { %s }
}"""


@pytest.mark.parametrize(
    ("reward", "best"),
    [
        ("3 * decrease(boxes)", 3 * 2),  # two are full
        ("decrease(boxes) - decrease(pairs)", 2 + 16 - 1),  # one pair of 16 is near
        ("2 * boxes", 5 * 2 * 4),  # in each of five steps all four
        ("decrease(boxes) - 2 * pairs", 2),
        ("4 * goal + decrease(boxes)", 4 + 2),
        ("decrease(boxes) + cost", 2 + 5 * 2),  # two are earned by each step
    ],
)
def test_the_most_that_can_be_got_is_bounded(reward: str, best: Fraction) -> None:
    domain = load_domain(Source("pay.nid", REWARDS % reward))
    text = """problem p { domain = pay  objects { a b c d - box } horizon = 5
      init { full(a) full(b) near(a, b) } goal { full(a), full(b), full(c), full(d) } }"""
    assert most(domain, load_problem(Source("p.nid", text), domain)) == best


def test_only_what_can_be_learned_is_hoped_of() -> None:
    domain = doors("0.1")
    problem = load_problem(Source("p.nid", DOORS), domain)
    hoped = optimistic(domain, problem, {0, 1})
    assert hoped.rules[0] == domain.rules[0]
    assert [float(outcome.probability) for outcome in hoped.rules[1].outcomes] == [1]
    assert optimistic(domain, problem, ()) == domain
    shut = load_problem(Source("q.nid", "problem q { domain = doors objects { } init { } }"), domain)
    assert optimistic(domain, shut, {1}) == domain


def test_the_shipped_rules_clean_less_than_twice_as_slowly(tmp_path: Path) -> None:
    """They are optimistic already, so that hoping for more is exploring what was known to be worse."""
    seconds = {"prior": 0.0, "rmax": 0.0}
    for optimism in seconds:
        for seed in (1, 2, 3):
            result = execute(
                *("cleaning", "three_areas"),
                learn=True,
                optimism=optimism,
                seed=seed,
                samples=200,
                runs=tmp_path,
                video=False,
            )
            assert result.clean
            assert json.loads((result.folder / "run.json").read_text())["options"]["optimism"] == optimism
            seconds[optimism] += result.seconds["actions"]
    assert seconds["prior"] < seconds["rmax"] < 2 * seconds["prior"]


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--optimism", "rmax"], "ask for learning"),
        (["--optimism", "rmax", "--learn", "--strategy", "reactive"], "the strategy reactive has none"),
        (["--optimism", "hope", "--learn"], "'hope' is not one of 'prior', 'rmax'"),
    ],
)
def test_hope_without_use_is_refused(
    words: list[str], said: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(["execute", "cleaning", "three_areas", "--runs", str(tmp_path / "runs"), *words]) == 2
    assert said in capsys.readouterr().err


def test_a_run_goes_on_as_hopefully_as_it_began(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("d.nid").write_text(TEXT % "0.1", encoding="utf-8")
    Path("p.nid").write_text(DOORS, encoding="utf-8")

    def stop(event: object) -> None:
        if isinstance(event, Acted) and event.number == 4:
            raise KeyboardInterrupt

    asked = partial(
        execute,
        *("d.nid", "p.nid"),
        strategy="plan-1",
        learn=True,
        optimism="rmax",
        known=KNOWN,
        samples=200,
        video=False,
    )
    whole = asked()
    with pytest.raises(KeyboardInterrupt) as stopped:
        asked(on_event=stop)
    gone_on = resume(stopped.value.folder)  # type: ignore[attr-defined]
    assert acted(gone_on.folder) == acted(whole.folder)
    assert {action for _, action in acted(whole.folder)[:KNOWN]} == {"lift"}


def acted(folder: Path) -> list[tuple[int, str]]:
    records = read_journal(folder).records
    return [(each.number, each.action) for each in records if isinstance(each, ActedEntry)]
