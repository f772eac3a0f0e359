"""Pushing blocks into a zone: whole episodes, rivals, and what is told of them."""

from __future__ import annotations

from contextlib import closing
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from cleancli.api.run_result import RunResult
from cleancli.execution.baselines import gather_all, nearest_first, wipe_all
from cleancli.execution.episode_state import Situation
from cleancli.execution.events import Ended
from cleancli.execution.loop import clean
from cleancli.execution.session import table_session
from cleancli.execution.setup import DecisionContext, EpisodeOptions, Job, usual_job, within_reach
from cleancli.execution.trials import TrialResult, attempt
from cleancli.geometry.ellipse import Ellipse
from cleancli.language.diagnostics.refused import Refused
from cleancli.language.model import Problem
from cleancli.motion.zone import inwards
from cleancli.perception.area import Area
from cleancli.scene.model import Group, Scene, Zone
from cleancli.scene.robots import ARMS
from cleancli.world.kinematic import KinematicTable
from support.shipped import shipped_domain, shipped_scene

DOMAIN, OPTIONS = shipped_domain("piles"), EpisodeOptions()


@pytest.fixture(scope="module")
def scene() -> Scene:
    """A small pile, not far from the zone."""
    return replace(
        shipped_scene("piles"),
        zone=Zone((0.15, 0.05), 0.12, 0.5),
        dirt=(Group(7, (-0.02, 0.0), 0.04, "blocks"),),
    )


def test_a_small_pile_ends_in_the_zone_with_a_few_pushes(scene: Scene) -> None:
    with closing(table_session(DOMAIN, scene, replace(OPTIONS, max_actions=8))) as session:
        assert session.setup.job is Job.ZONE
        (ended,) = (event for event in clean(session.setup, session.cell) if isinstance(event, Ended))
        truth = session.truth()
    assert ended.clean, ended.reason
    assert ended.actions <= 6, "one for each would be seven"
    assert (truth["in_zone"], truth["on_table"], truth["particles"]) == (7, 0, 7)
    assert truth["left_on_table_at"] == []


def test_the_job_is_the_zone_where_the_domain_knows_no_other_way() -> None:
    assert usual_job(DOMAIN, ARMS["gantry"]) is usual_job(DOMAIN, ARMS["reem"]) is Job.ZONE
    assert usual_job(shipped_domain("cleaning"), ARMS["gantry"]) is Job.CONTAINER
    assert not within_reach(DOMAIN, ARMS["gantry"], Job.CONTAINER).actions


def test_rivals_push_into_the_zone_too(scene: Scene) -> None:
    places = (-0.2, 0.0), (-0.05, 0.1), (0.02, -0.1)
    areas = tuple(Area(Ellipse(place, (0.007, 0.006), 0.0), 1e-4, f"a{n}") for n, place in enumerate(places))
    situation = Situation(areas, (), frozenset())
    problem = Problem("here", "piles", (), frozenset())
    now = DecisionContext(
        DOMAIN, problem, scene, Job.ZONE, situation, (0.0, 0.0), frozenset(), (), 0, 1, lambda actions: {}
    )
    (first,) = nearest_first(now, OPTIONS).moves
    assert first.key == ("pushToZone", ("a0",)), "the farthest from the zone"
    gather, last = gather_all(now, OPTIONS).moves
    assert (gather.action, last.action) == ("gather", "pushToZone")
    moves = wipe_all(now, OPTIONS).moves
    assert len(moves) > 1
    assert scene.zone is not None
    for move in moves:
        assert move.path is not None
        end = move.path.waypoints[-1]
        assert inwards(scene.zone, np.array([(end.x, end.y)]))[0] > 0


def test_a_trial_is_judged_by_what_is_left_outside_of_the_zone(scene: Scene) -> None:
    one = replace(scene, dirt=(Group(1, (0.0, 0.0), 1e-3, "blocks"),))
    trial = attempt(one, "pushToZone", (), 1)
    assert (trial.outcome, trial.left, trial.lost) == (TrialResult.NONE_LEFT, 0, 0)


def test_a_scene_without_a_zone_is_refused_and_the_stand_in_has_none(scene: Scene) -> None:
    session = table_session(DOMAIN, replace(scene, zone=None), OPTIONS)
    with closing(session), pytest.raises(Refused, match="E518"):
        list(clean(session.setup, session.cell))
    with pytest.raises(ValueError, match="without ink or a zone"):
        KinematicTable(scene, 1)


def test_the_summary_tells_of_the_zone() -> None:
    truth = {"particles": 50, "in_zone": 47, "in_container": 0, "on_table": 3, "on_floor": 0}
    more = {**truth, "in_dustpan": 0, "ink_left": None, "left_on_table_at": [[0.1, 0.2]]}
    told = str(RunResult(Path("run"), False, "done", 20, {"actions": 1.0}, more, "", False, {}))
    assert (
        "truly: 47 of 50 particles in the zone, 0 in the container, 3 elsewhere on the table, 0 on the floor"
        in told
    )
