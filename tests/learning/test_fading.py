"""Old examples that fade, and when a rule began to do something else (docs/learning.md)."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from random import Random

import numpy as np
import pytest
from scipy import special, stats

from cleancli.api.learned import LearningResult
from cleancli.api.lessons import learn
from cleancli.cli.main import run
from cleancli.language.load import load_domain, read_source
from cleancli.learning.changes import FEWEST, SIGNIFICANT, fluctuation, kolmogorov

TEXT = """domain coins {
  types { coin }
  predicates { heads(?c - coin) near(?c ?d - coin) [symmetric] }
  derived { up := count ?c - coin: heads(?c) }
  actions { flip(?c - coin) [duration = 9 s]  turn(?c - coin) }
  rule flip_it: flip(?c) {
    when not heads(?c)
    then 0.5: heads(?c)
         rest: nothing
  }
  rule turn_near: turn(?c) {
    when heads(?c)
    then 0.5: not heads(?c), forall ?d - coin: near(?c, ?d) => not heads(?d)
         0.3: not heads(?c)
         rest: nothing
  }
  reward { decrease(up) }
}
"""


def flips(results: Sequence[bool], seconds: Sequence[float] | None = None) -> list[str]:
    """A line for each: whether the coin showed heads then."""
    return [
        json.dumps(
            {
                "action": "flip",
                "arguments": ["c"],
                "objects": {"c": "coin"},
                "before": [],
                "after": [["heads", ["c"], True]] if shown else [],
                "number": number,
            }
            | ({} if seconds is None else {"seconds": seconds[number]})
        )
        for number, shown in enumerate(results)
    ]


@pytest.fixture
def domain(tmp_path: Path) -> Path:
    path = tmp_path / "coins.nid"
    path.write_text(TEXT, encoding="utf-8")
    return path


def written(folder: Path, name: str, lines: Sequence[str]) -> Path:
    path = folder / name
    path.write_text("".join(f"{line}\n" for line in lines), encoding="utf-8")
    return path


def heads(result: LearningResult) -> float:
    return result.rules[0].outcomes[0].probability


def test_an_example_counts_for_less_than_the_next_one(domain: Path, tmp_path: Path) -> None:
    results = [True, False, False, True, True, False, True]
    given = written(tmp_path, "a.jsonl", flips(results))
    found = learn(domain, given, estimator="m", m=4.0, forgetting=0.25)
    weights = [0.75**age for age in reversed(range(7))]
    seen = sum(weight for weight, shown in zip(weights, results, strict=True) if shown)
    assert found.rules[0].outcomes[0].seen == pytest.approx(seen, abs=0.0051)
    assert heads(found) == pytest.approx((seen + 4 * 0.5) / (sum(weights) + 4), abs=0.0001)


def test_what_a_coin_did_long_ago_is_forgotten(domain: Path, tmp_path: Path) -> None:
    random = Random(3)
    results = [random.random() < 0.9 for _ in range(200)] + [random.random() < 0.2 for _ in range(100)]
    given = written(tmp_path, "a.jsonl", flips(results))
    assert heads(learn(domain, given)) == pytest.approx(0.67, abs=0.07)
    assert heads(learn(domain, given, forgetting=0.05)) == pytest.approx(0.2, abs=0.15)


def test_adding_is_learning_from_all_at_once(domain: Path, tmp_path: Path) -> None:
    random = Random(4)
    lines = flips([random.random() < 0.7 for _ in range(60)], [random.uniform(3, 6) for _ in range(60)])
    whole = learn(domain, written(tmp_path, "whole.jsonl", lines), forgetting=0.1)
    learn(domain, written(tmp_path, "a.jsonl", lines[:45]), forgetting=0.1, write=True)
    assert "forgetting = 0.1" in domain.read_text(encoding="utf-8")
    # What the file says of forgetting holds on.
    added = learn(domain, written(tmp_path, "b.jsonl", lines[45:]), add=True)
    assert heads(added) == pytest.approx(heads(whole), abs=0.001)
    assert added.rules[0].outcomes[0].seen == pytest.approx(whole.rules[0].outcomes[0].seen, abs=0.02)
    (duration,), (at_once,) = added.durations, whole.durations
    assert duration.seconds == pytest.approx(at_once.seconds, abs=0.011)
    assert duration.seen == pytest.approx(at_once.seen, abs=0.02)
    assert at_once.seen == pytest.approx(10, abs=0.05)  # 1 / 0.1


def test_a_duration_follows_what_it_becomes(domain: Path, tmp_path: Path) -> None:
    given = written(tmp_path, "a.jsonl", flips([True] * 80, [5.0] * 40 + [8.0] * 40))
    (kept,) = learn(domain, given).durations
    (faded,) = learn(domain, given, forgetting=0.1).durations
    assert kept.seconds == pytest.approx(6.5, abs=0.02)
    assert faded.seconds == pytest.approx(8, abs=0.1)


@pytest.mark.parametrize("share", ["0.6", "-0.1", "much"])
def test_a_share_that_cannot_be_forgotten_is_refused(domain: Path, share: str) -> None:
    block = f"learned {{ estimator = m  m = 3  match = strict  forgetting = {share} }}"
    domain.write_text(TEXT.replace("  reward", f"  {block}\n  reward"), encoding="utf-8")
    assert run(["check", str(domain)]) == 1


# ---- when a rule began to do something else


def test_a_change_is_told_with_its_place(domain: Path, tmp_path: Path) -> None:
    random = Random(5)
    first = written(tmp_path, "a.jsonl", flips([random.random() < 0.9 for _ in range(60)]))
    results = [random.random() < 0.9 for _ in range(40)] + [random.random() < 0.3 for _ in range(80)]
    second = written(tmp_path, "b.jsonl", flips(results))
    found = learn(domain, first, second)
    (change,) = found.rule_changes
    assert change.rule == "flip_it"
    assert Path(change.experience).name == "b.jsonl"
    assert change.transition == pytest.approx(41, abs=6)
    assert change.p < 1e-6
    assert change.before[0] == pytest.approx(0.9, abs=0.1)
    assert change.after[0] == pytest.approx(0.3, abs=0.12)
    (told,) = [note for note in found.notes if "does something else" in note]
    assert f"flip_it does something else since transition {change.transition} of {second}" in told


def test_what_was_counted_before_shifts_no_place(domain: Path, tmp_path: Path) -> None:
    random = Random(6)
    lines = flips([random.random() < 0.9 for _ in range(100)] + [random.random() < 0.2 for _ in range(60)])
    path = written(tmp_path, "a.jsonl", lines[:50])
    learn(domain, path, write=True)
    written(tmp_path, "a.jsonl", lines)
    (change,) = learn(domain, path, add=True).rule_changes
    assert change.transition == pytest.approx(101, abs=6)


def test_two_changes_are_two(domain: Path, tmp_path: Path) -> None:
    random = Random(7)
    results = [random.random() < chance for chance in [0.9] * 100 + [0.2] * 100 + [0.9] * 100]
    found = learn(domain, written(tmp_path, "a.jsonl", flips(results))).rule_changes
    assert [change.transition for change in found] == pytest.approx([101, 201], abs=6)
    assert found[0].after == found[1].before


def test_more_work_near_by_is_no_change(domain: Path, tmp_path: Path) -> None:
    """First nothing lies near, so that two outcomes look alike, and later it does."""
    random = Random(8)
    lines = []
    for number in range(400):
        near = number >= 200
        draw = random.random()
        others = [["heads", ["d"], True], *([["near", ["c", "d"], True]] if near else [])]
        after = [["near", ["c", "d"], True]] if near else []
        if draw >= 0.5 or not near:
            after = [*after, ["heads", ["d"], True]]
        if draw >= 0.8:
            after = [*after, ["heads", ["c"], True]]
        record = {
            "action": "turn",
            "arguments": ["c"],
            "objects": {"c": "coin", "d": "coin"},
            "before": [["heads", ["c"], True], *others],
            "after": after,
            "number": number,
        }
        lines.append(json.dumps(record))
    found = learn(domain, written(tmp_path, "a.jsonl", lines))
    assert found.rules[0].outcomes[0].probability == pytest.approx(0.5, abs=0.1)
    assert found.rule_changes == ()


@pytest.mark.parametrize("chances", [(0.6, 0.3, 0.1), (0.95, 0.05), (0.25, 0.25, 0.25, 0.25)])
@pytest.mark.parametrize("number", [FEWEST, 60, 300])
def test_where_nothing_changes_chance_is_rarely_taken_for_a_change(
    chances: tuple[float, ...], number: int
) -> None:
    random = np.random.default_rng(number)
    values = [
        fluctuation(np.eye(len(chances))[random.choice(len(chances), number, p=chances)])[0]
        for _ in range(400)
    ]
    alarms = sum(value < SIGNIFICANT for value in values)
    # Declared is 0.01 of 400; more than 10 would have a chance of 0.003.
    assert alarms <= 10
    assert stats.binomtest(sum(value < 0.1 for value in values), 400, 0.1, "greater").pvalue > 1e-4


def test_the_statistic_is_that_of_a_slow_reference() -> None:
    """Of two outcomes the bridge is the count of one above what is expected of it, over its spread."""
    random = Random(9)
    for _ in range(20):
        results = [random.random() < 0.6 for _ in range(50)]
        share = sum(results) / 50
        spread = (share * (1 - share) * 50) ** 0.5
        furthest = max(abs(sum(results[:end]) - end * share) / spread for end in range(51))
        # The tail of Kolmogorov's distribution.
        terms = [(-1) ** (k - 1) * np.exp(-2 * k**2 * furthest**2) for k in range(1, 200)]
        shares = np.array([[shown, not shown] for shown in results], dtype=float)
        assert fluctuation(shares)[0] == pytest.approx(min(1, 2 * sum(terms)), abs=1e-9)


@pytest.mark.parametrize("distance", [0.01, 0.19, 0.2, 0.21, 0.3, 0.5, 1.0, 1.628, 3.0, 8.0])
def test_the_tail_of_kolmogorovs_distribution_is_that_of_scipy(distance: float) -> None:
    assert kolmogorov(distance) == pytest.approx(special.kolmogorov(distance), rel=1e-9, abs=1e-12)


def test_results_that_take_turns_are_no_change() -> None:
    """They are more even than chance makes them: so small a statistic is certain to be exceeded."""
    assert fluctuation(np.eye(2)[np.arange(10_000) % 2])[0] == 1


def test_the_command_tells_changes(domain: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    random = Random(10)
    lines = flips([random.random() < 0.9 for _ in range(60)] + [random.random() < 0.2 for _ in range(60)])
    path = written(tmp_path, "a.jsonl", lines)
    assert run(["learn", str(domain), str(path)]) == 0
    assert "flip_it does something else since transition" in capsys.readouterr().out
    assert run(["learn", str(domain), str(path), "--json"]) == 0
    (change,) = json.loads(capsys.readouterr().out)["rule_changes"]
    assert (change["rule"], change["experience"]) == ("flip_it", str(path))
    assert run(["learn", str(domain), str(path), "--forgetting", "0.05", "--write"]) == 0
    noted = load_domain(read_source(domain)).learned
    assert noted is not None
    assert noted.forgetting == 0.05
