"""The hidden rules of benchmarks/new_grasp.py are what docs/physics.md measured."""

from __future__ import annotations

from pathlib import Path

import pytest

from cleancli.language.find import find
from cleancli.language.load import load_domain, read_source
from cleancli.language.model import Domain

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(scope="module")
def shipped() -> Domain:
    return load_domain(read_source(find("cleaning", "domains")))


@pytest.mark.parametrize("grasp", ["folded", "corner"])
def test_shares_and_seconds_are_those_of_the_page(
    grasp: str, shipped: Domain, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.syspath_prepend(str(ROOT / "benchmarks"))
    import new_grasp

    shares = new_grasp.measured()
    true = new_grasp.true_rules(shipped, shares, grasp)
    (rule,) = (rule for rule in true.rules if rule.name == "fast_medium")
    by_end = dict.fromkeys(("none", "some", "spread"), 0.0)
    for outcome in rule.outcomes:
        by_end[new_grasp._end(outcome)] += float(outcome.probability)
    none, some, spread, seconds = shares["moveToContainerFast", "compact", grasp]
    seconds = (seconds + shares["moveToContainerFast", "scattered", grasp][3]) / 2
    assert tuple(by_end.values()) == pytest.approx((none, some, spread), abs=0.011)
    assert next(a for a in true.actions if a.name == "moveToContainerFast").duration == pytest.approx(seconds)
    for each in true.rules:
        assert sum(outcome.probability for outcome in each.outcomes) == 1
        assert all(outcome.probability >= 0 for outcome in each.outcomes)
    # What the page has no row for stays as it ships.
    assert len(true.rules) == len(shipped.rules)
