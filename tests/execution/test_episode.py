"""A real episode on the pybullet table, its record, and tables that will not get clean."""

from __future__ import annotations

import json
from collections.abc import Mapping
from contextlib import closing
from dataclasses import replace
from pathlib import Path
from typing import Any

import av
import pytest

from cleancli.execution.events import Acted, Checkpoint, Decided, Ended, Event, Looked, Moved
from cleancli.execution.loop import clean
from cleancli.execution.seeds import Stream, derived
from cleancli.execution.session import table_session
from cleancli.execution.setup import EpisodeOptions, Job, usual_job, within_reach
from cleancli.execution.table_cell import look_once
from cleancli.language.model import Domain
from cleancli.learning.experience import read_experience
from cleancli.recording.journal_writer import Entries
from cleancli.recording.run_folder import Recorder
from cleancli.scene.model import Scene
from cleancli.scene.robots import ARMS
from cleancli.world.table import PybulletTable
from support.pictures import picture
from support.shipped import shipped_domain, shipped_scene


@pytest.fixture(scope="module")
def domain() -> Domain:
    return shipped_domain("cleaning")


@pytest.fixture(scope="module")
def scene() -> Scene:
    return shipped_scene("two_groups")


@pytest.fixture(scope="module")
def episode(
    domain: Domain, scene: Scene, tmp_path_factory: pytest.TempPathFactory
) -> tuple[list[Event], Mapping[str, Any], Path]:
    """The events of one run, where the lentils were after it, and its folder."""
    folder = tmp_path_factory.mktemp("run")
    events = []
    with closing(table_session(domain, scene, EpisodeOptions(samples=2000))) as session:
        entries = Entries(session.setup.domain, lambda: session.cell.clock)
        with Recorder(folder, {"seed": 1}, session.picture, True, entries, session.save) as recorder:
            for event in clean(session.setup, session.cell):
                recorder.write(event)
                events.append(event)
        truth = session.truth()
        recorder.finish({"in_container": truth["in_container"]})
    return events, truth, folder


def test_a_real_table_ends_clean(episode: tuple[list[Event], Mapping[str, Any], Path]) -> None:
    events, truth, _ = episode
    ended = events[-1]
    assert isinstance(ended, Ended)
    assert ended.clean
    assert truth["particles"] == 28
    assert truth["in_container"] >= 27
    assert ended.reason == "nothing is left to do"


def test_time_is_accounted_for(episode: tuple[list[Event], Mapping[str, Any], Path]) -> None:
    events, _, _ = episode
    ended = events[-1]
    assert isinstance(ended, Ended)
    spent, acted = ended.spent, [event for event in events if isinstance(event, Acted)]
    assert ended.clock == pytest.approx(max(e.clock for e in events if isinstance(e, Moved)), abs=0.05)
    assert spent.actions == pytest.approx(sum(event.seconds for event in acted))
    assert spent.transits == pytest.approx(sum(event.transit for event in acted))
    assert all(0.3 < event.transit < 6 < event.transit + event.seconds < 20 for event in acted)
    assert spent.planning == pytest.approx(sum(e.seconds for e in events if isinstance(e, Decided)))
    # The rest of the robot's time went into moving the arm out of view, which the last looks are for.
    aside = ended.clock - spent.actions - spent.transits
    extra = [e.seconds for e in events if isinstance(e, Looked) and e.purpose.value == "extra"]
    assert 0.5 < aside == pytest.approx(spent.extra_perceptions - sum(extra))
    assert spent.total == pytest.approx(ended.clock + spent.planning + spent.perceiving + sum(extra))
    assert spent.learning == 0


def test_checkpoints_stand_between_all_moves(episode: tuple[list[Event], Mapping[str, Any], Path]) -> None:
    events, _, _ = episode
    states = [event.state for event in events if isinstance(event, Checkpoint)]
    assert {state.actions for state in states} == set(range(states[-1].actions + 1))
    assert states[-1].reason == "nothing is left to do"


def test_the_record_is_whole(episode: tuple[list[Event], Mapping[str, Any], Path], domain: Domain) -> None:
    events, truth, folder = episode
    acted = [event for event in events if isinstance(event, Acted)]
    text = (folder / "experience.jsonl").read_text(encoding="utf-8")
    seen = [event for event in acted if event.seen]
    assert seen, "nothing was seen whole"
    read = tuple(read_experience(folder / "experience.jsonl", domain))
    assert read == tuple(event.transition for event in seen)
    assert [json.loads(line)["number"] for line in text.splitlines()] == [event.number for event in seen]
    run = json.loads((folder / "run.json").read_text(encoding="utf-8"))
    assert run["episode"]["actions"] == len(acted)
    assert run["episode"]["clean"] is True
    assert run["truth"] == {"in_container": truth["in_container"]}
    pictures = sorted(folder.glob("step-*.png"))
    assert len(pictures) == len(acted) + 1
    assert all(picture(path).std() > 10 for path in pictures)
    with av.open(str(folder / "video.mp4")) as video:
        frames = [frame.to_ndarray(format="rgb24") for frame in video.decode(video=0)]
    assert len(frames) > 20
    assert frames[0].std() > 10


def test_areas_that_are_gone_are_remembered_without_dirt(
    episode: tuple[list[Event], Mapping[str, Any], Path], domain: Domain
) -> None:
    events, _, _ = episode
    gone = [
        (event.transition, name)
        for event in events
        if isinstance(event, Acted) and event.transition is not None
        for name in event.transition.arguments
        if name not in {area.name for area in event.situation.areas}
    ]
    assert gone, "nothing was cleaned"
    for transition, name in gone:
        assert ("dirt", (name,)) not in transition.after
        assert ("size", (name,)) in transition.after


def test_the_same_seed_sees_the_same(domain: Domain, scene: Scene) -> None:
    def first() -> object:
        with closing(PybulletTable(scene, derived(4, Stream.WORLD))) as table:
            return look_once(domain, scene, table, 4)

    assert first() == first()


def test_a_one_armed_robot_is_not_asked_to_pick_up(domain: Domain) -> None:
    names = {action.name for action in within_reach(domain, ARMS["gantry"]).actions}
    assert names == {a.name for a in domain.actions} - {"pickUp"}
    assert {rule.action for rule in within_reach(domain, ARMS["gantry"]).rules} == names


def test_a_job_leaves_out_the_other_way_of_cleaning(domain: Domain) -> None:
    everything = {a.name for a in domain.actions}
    pushes = {"moveToContainerFast", "moveToContainerStraight"}
    assert {a.name for a in within_reach(domain, ARMS["reem"], Job.DUSTPAN).actions} == everything - pushes
    pushing = {a.name for a in within_reach(domain, ARMS["reem"], Job.CONTAINER).actions}
    assert pushing == everything - {"pickUp"}


def test_what_a_robot_does_unless_told_otherwise(domain: Domain) -> None:
    assert [usual_job(domain, ARMS[robot]) for robot in ("gantry", "reem")] == [Job.CONTAINER, Job.DUSTPAN]
    board = shipped_domain("wiping_ink")
    assert [usual_job(board, ARMS[robot]) for robot in ("gantry", "reem")] == [Job.WIPE, Job.WIPE]
    assert within_reach(board, ARMS["gantry"], Job.WIPE) == board
    both = replace(domain, actions=(*domain.actions, *board.actions))
    neither = replace(domain, actions=())
    for known in (both, neither):
        assert [usual_job(known, ARMS[robot]) for robot in ("gantry", "reem")] == [Job.CONTAINER, Job.DUSTPAN]


def test_two_arms_sweep_several_areas_onto_the_dustpan_and_one_into_the_container() -> None:
    """docs/execution.md: the same domain for both."""
    sweeping = shipped_domain("sweeping")
    picking, pushing = {"pickUp", "pickUp2", "pickUp3"}, {"sweep1", "sweep2", "sweep3"}
    usual = within_reach(sweeping, ARMS["reem"], usual_job(sweeping, ARMS["reem"]))
    assert {a.name for a in usual.actions} == picking
    assert {a.name for a in within_reach(sweeping, ARMS["reem"], Job.CONTAINER).actions} == pushing
    assert {a.name for a in within_reach(sweeping, ARMS["gantry"]).actions} == pushing
