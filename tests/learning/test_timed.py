"""How long actions take: what is estimated, and what the text says then (docs/learning.md)."""

from __future__ import annotations

import json
import statistics
from pathlib import Path
from random import Random

import pytest

from cleancli.api.learned import LearningResult
from cleancli.api.lessons import learn
from cleancli.language.diagnostics.refused import Refused

TEXT = """domain coins {
  types { coin }
  predicates { heads(?c - coin) }
  derived { up := count ?c - coin: heads(?c) }
  actions { flip(?c - coin) [duration = %s]  wait() }
  rule flip_it: flip(?c) { when not heads(?c) then 0.5: heads(?c) rest: nothing }
  reward { decrease(up) }
}
"""


def line(seconds: float, transit: float | None = None, action: str = "flip") -> str:
    record = {
        "action": action,
        "arguments": ["c"] if action == "flip" else [],
        "objects": {"c": "coin"},
        "before": [],
        "after": [],
        "seconds": seconds,
    }
    return json.dumps(record if transit is None else {**record, "transit": transit}) + "\n"


def taught(
    folder: Path, stated: str, *lines: str, name: str = "a.jsonl", add: bool = False
) -> LearningResult:
    domain, given = folder / "coins.nid", folder / name
    if not domain.exists():
        domain.write_text(TEXT % stated, encoding="utf-8")
    given.write_text("".join(lines), encoding="utf-8")
    return learn(domain, given, write=True, add=add)


def test_the_text_says_what_was_learned_of_a_duration(tmp_path: Path) -> None:
    result = taught(tmp_path, "9 s", *[line(4.8, 1.0)] * 12, line(3.0, action="wait"))
    (duration,) = result.durations
    assert (duration.action, duration.prior, duration.seen, duration.spread) == ("flip", 9, 12, 0)
    # (12 * 5.8 + 9 / sqrt(12)) / (12 + 1 / sqrt(12))
    assert duration.seconds == pytest.approx(5.88, abs=0.005)
    assert "flip(?c - coin) [duration = 5.88 s [prior 9 s, seen 12]]  wait()" in result.text
    assert learn(tmp_path / "coins.nid", tmp_path / "a.jsonl").diff == ""


@pytest.mark.parametrize("stated", [3.0, 9.0])
def test_a_prior_that_is_off_by_half_is_nearly_forgotten_after_twelve(tmp_path: Path, stated: float) -> None:
    (duration,) = taught(tmp_path, f"{stated} s", *[line(6.0)] * 12).durations
    assert duration.seconds == pytest.approx(6.0, rel=0.02)


def test_mean_and_spread_are_those_of_the_times(tmp_path: Path) -> None:
    random = Random(2)
    times = [round(random.gauss(20, 3), 3) for _ in range(400)]
    (duration,) = taught(tmp_path, "1 min", *map(line, times)).durations
    assert duration.spread == pytest.approx(statistics.stdev(times))
    weight = 1 / 20
    assert duration.seconds == pytest.approx((sum(times) + 60 * weight) / (400 + weight), abs=0.05)


def test_what_is_fixed_or_not_stated_stays(tmp_path: Path) -> None:
    result = taught(tmp_path, "9 s [fixed]", line(2.0), line(2.0, action="wait"))
    assert result.durations == ()
    assert "[duration = 9 s [fixed]]  wait()" in result.text


def test_added_times_count_on(tmp_path: Path) -> None:
    taught(tmp_path, "9 s", *[line(5.0)] * 4)
    (added,) = taught(tmp_path, "", *[line(7.0)] * 5, name="b.jsonl", add=True).durations
    assert added.seen == 9
    assert added.seconds == pytest.approx((4 * 5 + 5 * 7 + 9 / 3) / (9 + 1 / 3), abs=0.02)


@pytest.mark.parametrize("seconds", ["-1", "1e300", '"long"', "NaN"])
def test_absurd_times_are_refused(tmp_path: Path, seconds: str) -> None:

    with pytest.raises(Refused):
        taught(tmp_path, "9 s", line(1.0).replace("1.0", seconds))
