"""Exploration on a table (docs/learning.md): from a vocabulary alone, by the fast stand-in for the table."""

from __future__ import annotations

from dataclasses import replace

import pytest

from cleancli.execution.events import Acted, Ended
from cleancli.execution.loop import CLEAN, clean
from cleancli.execution.session import stand_in_session
from cleancli.execution.setup import EpisodeOptions
from cleancli.learning.experience import Transition
from cleancli.learning.exploration.explored import explored
from cleancli.learning.method import DEFAULT
from support.shipped import shipped_domain, shipped_scene

VOCABULARY = replace(shipped_domain("cleaning"), rules=(), default=(), parameters=(), learned=None)


def episode(scene: str, seed: int, seen: list[Transition]) -> tuple[list[Transition], str]:
    """What is seen in an episode after all that was seen before, and why it ended."""
    options = EpisodeOptions(
        "explore", samples=50, seed=seed, max_actions=12, learning=DEFAULT, structure=True, known=3
    )
    session = stand_in_session(VOCABULARY, shipped_scene(scene), options)
    done, reason = list[Transition](), ""
    for event in clean(replace(session.setup, experience=tuple(seen)), session.cell):
        match event:
            case Acted(transition=Transition() as transition, seen=True):
                done.append(transition)
            case Ended():
                reason = event.reason
    return done, reason


@pytest.mark.parametrize("scene", ["two_groups", "layout_c"])
def test_a_table_is_explored_until_it_is_clean(scene: str) -> None:
    """Each episode tries what those before have not, and in the end rules say how dirt goes away."""
    seen, ends = list[Transition](), []
    for seed in (1, 2, 3):
        done, reason = episode(scene, seed, seen)
        assert done
        seen += done
        ends.append(reason)
    assert CLEAN in ends
    assert len({each.action for each in seen}) >= 3
    rules = explored(VOCABULARY, seen).domain.rules
    removing = {rule.action for rule in rules if "dirt" in str(rule.outcomes)}
    assert removing & {"moveToContainerFast", "moveToContainerStraight"}


def test_the_same_seed_explores_a_table_the_same() -> None:
    assert episode("two_groups", 1, []) == episode("two_groups", 1, [])
