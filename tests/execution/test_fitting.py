"""What a checkpoint says is an episode's of this domain, or is refused with the reason."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from typing import Any

import pytest

from cleancli.compiler.task import GroundAction
from cleancli.execution.episode_state import (
    Account,
    Demonstration,
    EpisodeState,
    FailedAttempt,
    Move,
    Situation,
)
from cleancli.execution.setup import MOST
from cleancli.geometry.ellipse import Ellipse
from cleancli.language.model import Fact, Object
from cleancli.motion.actions import path_along
from cleancli.motion.path import ToolPath
from cleancli.perception.area import Area
from cleancli.recording.fitting import check_fits
from support.shipped import shipped_domain, shipped_scene

DOMAIN = shipped_domain("cleaning")
PATH = path_along(((-0.1, 0.0), (0.1, 0.0)), shipped_scene("two_groups"))
AREA = Area(Ellipse((0.1, -0.2), (0.03, 0.02), 0.4), 3e-4, "a1")
OBJECTS = (Object("a1", "area"), Object("a2", "area"))
FACTS = frozenset({Fact("dirt", ("a1",)), Fact("size", ("a1",), "small"), Fact("near", ("a1", "a2"))})
SITUATION = Situation((AREA,), OBJECTS, FACTS, hidden=0.3)
PUSH = Move("moveToContainerFast", ("a1",))
STATE = EpisodeState(
    situation=SITUATION,
    looks=3,
    named=2,
    actions=1,
    queue=(PUSH, Move("wipe", (), PATH)),
    rest=(GroundAction("join2", ("a1", "a2"), 7.5),),
    vain=(FailedAttempt(PUSH.key, (AREA,), FACTS, 2),),
    examples=((0, Fraction(5, 2)), (len(DOMAIN.rules) - 1, Fraction(1))),
    shown=(Demonstration(FACTS, PUSH),),
    spent=Account(planning=0.5, transits=3.0),
)


def placed(**changes: Any) -> Area:
    return replace(AREA, ellipse=replace(AREA.ellipse, **changes))


def around(*areas: Area) -> dict[str, Any]:
    return {"situation": replace(SITUATION, areas=areas)}


def believed(**changes: Any) -> dict[str, Any]:
    return {"situation": replace(SITUATION, **changes)}


def gone(**changes: Any) -> dict[str, Any]:
    """The second waypoint of a path is another one."""
    first, second, *others = PATH.waypoints
    return {
        "queue": (Move("wipe", (), replace(PATH, waypoints=(first, replace(second, **changes), *others))),)
    }


@pytest.mark.parametrize("given", [None, OBJECTS])
def test_an_episode_of_the_domain_fits(given: tuple[Object, ...] | None) -> None:
    check_fits(STATE, DOMAIN, given)
    check_fits(EpisodeState(), DOMAIN, given)
    check_fits(replace(STATE, **around(placed(centre=(-999.0, 999.0), axes=(1e3, 0.0)))), DOMAIN, given)
    check_fits(replace(STATE, rest=(GroundAction("pickUp", ("a1",), None),)), DOMAIN, given)
    check_fits(replace(STATE, actions=MOST, spent=Account(actions=float(MOST))), DOMAIN, given)


@pytest.mark.parametrize(
    ("changes", "reason"),
    [
        ({"looks": -1}, "its counts or seconds are absurd"),
        ({"actions": 10**10}, "its counts or seconds are absurd"),
        ({"loading": float("nan")}, "its counts or seconds are absurd"),
        ({"spent": Account(actions=-1.0)}, "its counts or seconds are absurd"),
        ({"vain": (replace(STATE.vain[0], times=-1),)}, "its counts or seconds are absurd"),
        ({"examples": ((0, -2),)}, "its counts or seconds are absurd"),
        ({"examples": ((len(DOMAIN.rules), 2),)}, "it has seen rules that the domain has not"),
        (believed(hidden=1.1), "the share that was hidden is none"),
        (believed(hidden=-0.1), "the share that was hidden is none"),
        (believed(objects=(*OBJECTS, OBJECTS[0])), "its objects are not of this domain"),
        (believed(objects=(*OBJECTS, Object("a3", "spoon"))), "its objects are not of this domain"),
        (believed(state=frozenset({Fact("wet", ("a1",))})), "the domain has no 'wet' for 1"),
        (believed(state=frozenset({Fact("dirt", ("a1", "a2"))})), "the domain has no 'dirt' for 2"),
        (believed(state=frozenset({Fact("dirt", ("a7",))})), "the domain has no 'dirt' for 1"),
        (believed(state=frozenset({Fact("size", ("a1",), "huge")})), "size cannot be 'huge'"),
        (believed(state=frozenset({Fact("dirt", ("a1",), 1)})), "dirt cannot be 1"),
        (around(AREA, AREA), "its areas are not named as areas are"),
        (around(replace(AREA, name="b1")), "its areas are not named as areas are"),
        (around(replace(AREA, name="a0")), "its areas are not named as areas are"),
        (around(replace(AREA, covered=-1e-9)), "a1 is nowhere near a table"),
        (around(placed(axes=(1001.0, 0.1))), "a1 is nowhere near a table"),
        (around(placed(axes=(0.1, -0.1))), "a1 is nowhere near a table"),
        (around(placed(centre=(0.0, -1001.0))), "a1 is nowhere near a table"),
        (around(placed(angle=float("nan"))), "a1 is nowhere near a table"),
        ({"vain": (replace(STATE.vain[0], areas=(replace(AREA, name=""),)),)}, "not named as areas are"),
        ({"vain": (replace(STATE.vain[0], chance=1.1),)}, "the chance of a failure is none"),
        ({"queue": (Move("sing", ()),)}, "the domain has no action 'sing' for 0 objects"),
        ({"queue": (Move("join2", ("a1",)),)}, "the domain has no action 'join2' for 1 object"),
        ({"shown": (Demonstration(FACTS, Move("sing", ())),)}, "the domain has no action 'sing' for 0"),
        ({"rest": (GroundAction("join2", ("a1",), 7.5),)}, "the domain has no action 'join2' for 1 object"),
        ({"rest": (GroundAction("join2", ("a1", "a2"), -1.0),)}, "would take -1 seconds"),
        ({"queue": (Move("wipe", (), ToolPath((), PATH.interpolation)),)}, "nowhere near a table"),
        (gone(x=1001.0), "a path leads nowhere near a table"),
        (gone(yaw=float("nan")), "a path leads nowhere near a table"),
    ],
)
def test_what_does_not_fit_is_refused_with_its_reason(changes: dict[str, Any], reason: str) -> None:
    with pytest.raises(ValueError, match=reason):
        check_fits(replace(STATE, **changes), DOMAIN, None)


def test_in_the_symbolic_world_objects_are_those_of_the_problem() -> None:
    with pytest.raises(ValueError, match="its objects are not those of the problem"):
        check_fits(STATE, DOMAIN, OBJECTS[:1])
    unknown = replace(STATE, queue=(Move("moveToContainerFast", ("a9",)),))
    check_fits(unknown, DOMAIN, None)
    with pytest.raises(ValueError, match=r"moveToContainerFast\(a9\) is about what the problem has not"):
        check_fits(unknown, DOMAIN, OBJECTS)


def test_a_path_may_not_take_for_ever() -> None:
    with pytest.raises(ValueError, match="a path takes hours"):
        check_fits(replace(STATE, **gone(speed=0.0)), DOMAIN, None)
    with pytest.raises(ValueError, match="a path takes hours"):
        check_fits(replace(STATE, **gone(speed=1e-7)), DOMAIN, None)
