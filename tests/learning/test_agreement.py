"""Whether experience agrees with a file: right files pass, and wrong ones are found (docs/learning.md)."""

from __future__ import annotations

import json
from collections import Counter
from pathlib import Path
from random import Random

import pytest
from scipy.stats import chi2, power_divergence

from cleancli.cli.main import run
from cleancli.language.diagnostics.diagnostic import Source
from cleancli.language.load import load_domain
from cleancli.learning.agreement import Agreement, agreements, disagreeing
from cleancli.learning.evidence import Evidence
from cleancli.learning.match import Fit, Match

TEXT = """domain coins {
  types { coin }
  predicates { heads(?c - coin)  edge(?c - coin) }
  derived { up := count ?c - coin: heads(?c) }
  actions { flip(?c - coin)  spin(?c - coin) }
  rule flip_it: flip(?c) { when not heads(?c), not edge(?c) then 0.6: heads(?c)  0.3: edge(?c)  0.1: nothing }
  rule spin_it: spin(?c) { when not heads(?c), not edge(?c) then 0.5: heads(?c)  0.5: nothing }
  reward { decrease(up) }
}
"""
DOMAIN = load_domain(Source("coins.nid", TEXT))
FLIPS = tuple(
    Match(0, tuple(Fit() if index == outcome else None for index in range(3))) for outcome in range(3)
)
"""Transitions of which is plain which outcome made them."""


def flips(*numbers: int) -> Evidence:
    order = [kind for kind, number in enumerate(numbers) for _ in range(number)]
    return Evidence(FLIPS, tuple(order))


def only(evidence: Evidence) -> Agreement:
    (found,) = agreements(DOMAIN, evidence)
    return found


@pytest.mark.parametrize("numbers", [(61, 29, 10), (50, 40, 10), (30, 30, 40), (600, 310, 90)])
def test_the_statistic_is_that_of_the_likelihood_ratio(numbers: tuple[int, int, int]) -> None:
    """Where outcomes are plain, against scipy's G-test."""
    found = only(flips(*numbers))
    expected = [sum(numbers) * chance for chance in (0.6, 0.3, 0.1)]
    statistic, p = power_divergence(numbers, expected, lambda_="log-likelihood")
    assert (found.rule, found.examples, found.freedom) == (0, sum(numbers), 2)
    assert found.statistic == pytest.approx(statistic, abs=1e-4)
    assert found.p == pytest.approx(p, abs=1e-5)
    assert found.p == pytest.approx(chi2.sf(statistic, 2), abs=1e-5)


def test_a_right_file_hardly_ever_disagrees_and_a_wrong_one_does() -> None:
    random = Random(5)
    alarms = 0
    for _ in range(300):
        drawn = Counter(random.choices(range(3), (0.6, 0.3, 0.1), k=200))
        alarms += bool(disagreeing(agreements(DOMAIN, flips(*(drawn[index] for index in range(3))))))
    # Declared is 0.01 of 300; 12 or more would have a chance of 0.0002.
    assert alarms < 12
    for _ in range(20):
        drawn = Counter(random.choices(range(3), (0.4, 0.3, 0.3), k=200))
        assert disagreeing(agreements(DOMAIN, flips(*(drawn[index] for index in range(3)))))


def test_an_example_that_nothing_explains_disagrees() -> None:
    explained = flips(60, 30, 10)
    odd = Match(0, (None, None, None))
    found = only(Evidence((*FLIPS, odd), (*explained.order, len(FLIPS))))
    assert (found.p, found.examples) == (0, 101)
    assert disagreeing((found,)) == (found,)


def line(after: list[object]) -> str:
    record = {"action": "flip", "arguments": ["c"], "objects": {"c": "coin"}, "before": [], "after": after}
    return json.dumps(record) + "\n"


def test_the_command_says_so_and_its_exit_code_too(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    domain, good, bad = (tmp_path / name for name in ("coins.nid", "good.jsonl", "bad.jsonl"))
    domain.write_text(TEXT, encoding="utf-8")
    heads, edge, nothing = line([["heads", ["c"], True]]), line([["edge", ["c"], True]]), line([])
    good.write_text(heads * 58 + edge * 33 + nothing * 9, encoding="utf-8")
    bad.write_text(heads * 20 + edge * 33 + nothing * 47, encoding="utf-8")
    assert run(["learn", str(domain), str(good), "--check"]) == 0
    assert "flip_it" in capsys.readouterr().out
    assert run(["learn", str(domain), str(bad), "--check", "--json"]) == 1
    told = json.loads(capsys.readouterr().out)
    assert told["agrees"] is False
    assert [(rule["rule"], rule["examples"], rule["agrees"]) for rule in told["rules"]] == [
        ("flip_it", 100, False)
    ]
    assert domain.read_text(encoding="utf-8") == TEXT
    assert run(["learn", str(domain), str(bad), "--check", "--write"]) == 2


def test_what_was_learned_from_experience_agrees_with_it(tmp_path: Path) -> None:
    domain, bad = tmp_path / "coins.nid", tmp_path / "bad.jsonl"
    domain.write_text(TEXT, encoding="utf-8")
    bad.write_text(line([["heads", ["c"], True]]) * 20 + line([]) * 60, encoding="utf-8")
    assert run(["learn", str(domain), str(bad), "--check"]) == 1
    assert run(["learn", str(domain), str(bad), "--write", "--estimator", "likelihood"]) == 0
    assert run(["learn", str(domain), str(bad), "--check"]) == 0
