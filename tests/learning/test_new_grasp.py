"""The hidden rules of benchmarks/new_grasp.py are what docs/measurements/physics.md reports."""

from __future__ import annotations

from pathlib import Path

import pytest

from cleancli.language.find import find
from cleancli.language.load import load_domain, read_source
from cleancli.language.model import Domain, Rule

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(scope="module")
def shipped() -> Domain:
    return load_domain(read_source(find("cleaning", "domains")))


def chances_of(rule: Rule) -> list[float]:
    return [float(outcome.probability) for outcome in rule.outcomes]


@pytest.mark.parametrize("grasp", ["folded", "corner"])
def test_shares_and_seconds_are_those_of_the_page(
    grasp: str, shipped: Domain, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.syspath_prepend(str(ROOT / "benchmarks"))
    import new_grasp

    shares = new_grasp.measured()
    true = new_grasp.true_rules(shipped, shares, grasp)
    rules = {rule.name: rule for rule in true.rules}
    medium = chances_of(rules["fast_medium"])
    none, some, spread, seconds = shares["moveToContainerFast", "compact", grasp]
    ends = (sum(medium[:2]), medium[2] + medium[4], medium[3])
    assert ends == pytest.approx((none, some, spread), abs=0.011)
    # What is compact now is still there: some is left. Another heap of what is scattered changes nothing.
    small = chances_of(rules["fast_scattered_small"])
    none, some, spread, _ = shares["moveToContainerFast", "scattered", grasp]
    ends = (sum(small[:2]), small[2], small[3])
    assert ends == pytest.approx((none, some / 2, some / 2 + spread), abs=0.011)
    # Of three areas that are to be joined two were: that is not one group.
    three = chances_of(rules["join_three_to_small"])
    none, some, spread, _ = shares["join3", "compact", grasp]
    ends = (three[0] + three[2], sum(three[3:]), three[1])
    assert ends == pytest.approx((none, some, spread), abs=0.011)
    grouped = chances_of(rules["group_scattered"])
    none, *_ = shares["groupScattered", "scattered", grasp]
    assert sum(grouped[:2]) == pytest.approx(none, abs=0.011)
    seconds = shares["moveToContainerFast", "compact", grasp][3]
    seconds = (seconds + shares["moveToContainerFast", "scattered", grasp][3]) / 2
    assert next(a for a in true.actions if a.name == "moveToContainerFast").duration == pytest.approx(seconds)
    for each in true.rules:
        assert sum(outcome.probability for outcome in each.outcomes) == 1
        assert all(outcome.probability >= 0 for outcome in each.outcomes)
    # What the page has no row for stays as it ships.
    assert len(true.rules) == len(shipped.rules)
