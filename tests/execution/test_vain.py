"""A move that was in vain is of no use as long as none of its objects has changed, whichever it is."""

from __future__ import annotations

from dataclasses import replace

import pytest
from numpy import pi

from cleancli.execution.episode_state import (
    PATIENCE,
    EpisodeState,
    FailedAttempt,
    Situation,
    about,
    unchanged,
)
from cleancli.geometry.ellipse import Ellipse
from cleancli.language.model import Fact, Object
from cleancli.perception.area import Area


def area(
    name: str, x: float, y: float, long: float = 0.03, covered: float = 1e-3, short: float = 0.02
) -> Area:
    return Area(Ellipse((x, y), (long, short), 0.2), covered * pi, name)


AREAS = (area("a1", 0.0, 0.0), area("a2", 0.2, 0.1), area("a3", -0.2, 0.1))
STATE = frozenset({Fact("dirt", ("a1",)), Fact("dirt", ("a2",)), Fact("near", ("a1", "a2"))})
BEFORE = Situation(AREAS, tuple(Object(each.name, "area") for each in AREAS), STATE)
JOINED = FailedAttempt(("join2", ("a1", "a2")), *about(("a1", "a2"), BEFORE), times=PATIENCE)
CHANGES = {
    "moved": (0.211, 0.1),
    "moved aside": (0.2, 0.089),
    "longer": (0.2, 0.1, 0.0405),
    "shorter": (0.2, 0.1, 0.0195),
    "dirtier": (0.2, 0.1, 0.03, 1.3e-3),
    "cleaner": (0.2, 0.1, 0.03, 0.75e-3),
}
ALIKE = {
    "the same": (0.2, 0.1),
    "nearly there": (0.209, 0.1),
    "nearly as long": (0.2, 0.1, 0.039),
    "nearly as dirty": (0.2, 0.1, 0.03, 1.2e-3),
}


def with_second(*values: float) -> Situation:
    return replace(BEFORE, areas=(AREAS[0], area("a2", *values), AREAS[2]))


@pytest.mark.parametrize("values", CHANGES.values(), ids=CHANGES)
def test_a_change_of_the_second_of_two_counts(values: tuple[float, ...]) -> None:
    assert not unchanged(JOINED, with_second(*values))
    assert not EpisodeState(with_second(*values), vain=(JOINED,)).excluded


@pytest.mark.parametrize("values", ALIKE.values(), ids=ALIKE)
def test_what_perception_may_err_by_is_no_change(values: tuple[float, ...]) -> None:
    assert unchanged(JOINED, with_second(*values))
    assert EpisodeState(with_second(*values), vain=(JOINED,)).excluded == {JOINED.key}


def test_what_happens_to_others_does_not_count_and_facts_do() -> None:
    moved = replace(BEFORE, areas=(*AREAS[:2], area("a3", 0.3, 0.3)))
    assert unchanged(JOINED, replace(moved, state=STATE | {Fact("dirt", ("a3",))}))
    assert not unchanged(JOINED, replace(BEFORE, state=STATE - {Fact("near", ("a1", "a2"))}))
    assert not unchanged(JOINED, replace(BEFORE, state=STATE | {Fact("scattered", ("a2",))}))
    assert not unchanged(JOINED, replace(BEFORE, areas=AREAS[:1]))


def test_patience_ends_at_its_number() -> None:
    assert not EpisodeState(BEFORE, vain=(replace(JOINED, times=PATIENCE - 1),)).excluded
    assert EpisodeState(BEFORE, vain=(replace(JOINED, times=PATIENCE + 1),)).excluded
    assert not EpisodeState(None, vain=(JOINED,)).excluded
