"""A real episode on the pybullet table, its record, and tables that will not get clean."""

from __future__ import annotations

import json
from collections.abc import Iterator
from contextlib import closing
from dataclasses import replace
from pathlib import Path

import av
import cv2
import pytest

from cleancli.execution.events import Acted, Ended, Event, Looked, Moved, Planned
from cleancli.execution.loop import EpisodeOptions, clean, look_once, within_reach
from cleancli.execution.record import Recorder, free_folder
from cleancli.execution.seeds import Purpose, derived
from cleancli.language.diagnostics import Source
from cleancli.language.load import load_domain, read_source
from cleancli.language.model import Domain
from cleancli.learning.experience import decode
from cleancli.motion.path import ToolPath
from cleancli.perception.frame import Frame
from cleancli.scene.check import load_scene
from cleancli.scene.model import Scene
from cleancli.shipped import find
from cleancli.world.robot import Status
from cleancli.world.table import PybulletTable, Truth


@pytest.fixture(scope="module")
def domain() -> Domain:
    return load_domain(read_source(find("cleaning", "domains")))


@pytest.fixture(scope="module")
def scene() -> Scene:
    return load_scene(read_source(find("two_groups", "problems")))


@pytest.fixture(scope="module")
def episode(
    domain: Domain, scene: Scene, tmp_path_factory: pytest.TempPathFactory
) -> tuple[list[Event], Truth, Path]:
    """The events of one run, where the lentils were after it, and its folder."""
    folder = free_folder(tmp_path_factory.mktemp("runs"), "run")
    events = []
    with closing(PybulletTable(scene, derived(1, Purpose.WORLD))) as table:
        with Recorder(folder, {"seed": 1}, table.picture, video=True) as recorder:
            for event in clean(domain, scene, table, EpisodeOptions(samples=2000)):
                recorder.write(event)
                events.append(event)
        truth = table.truth()
        recorder.finish({"in_container": truth.in_container})
    return events, truth, folder


def test_a_real_table_ends_clean(episode: tuple[list[Event], Truth, Path]) -> None:
    events, truth, _ = episode
    ended = events[-1]
    assert isinstance(ended, Ended)
    assert ended.clean
    assert truth.in_container >= 0.95 * truth.total
    assert truth.total == 28


def test_time_is_accounted_for(episode: tuple[list[Event], Truth, Path]) -> None:
    events, _, _ = episode
    ended = events[-1]
    assert isinstance(ended, Ended)
    last = max(event.clock for event in events if isinstance(event, Moved))
    assert ended.seconds["acting"] + ended.seconds["withdrawing"] == pytest.approx(last, abs=0.1)
    assert ended.seconds["acting"] == pytest.approx(sum(e.seconds for e in events if isinstance(e, Acted)))
    assert ended.seconds["planning"] == pytest.approx(
        sum(e.seconds for e in events if isinstance(e, Planned))
    )
    assert ended.seconds["perceiving"] == pytest.approx(
        sum(e.seconds for e in events if isinstance(e, Looked))
    )


def test_the_record_is_whole(episode: tuple[list[Event], Truth, Path], domain: Domain) -> None:
    events, truth, folder = episode
    acted = [event for event in events if isinstance(event, Acted)]
    text = (folder / "experience.jsonl").read_text(encoding="utf-8")
    assert decode(Source("x", text), domain) == tuple(event.transition for event in acted)
    assert [json.loads(line)["number"] for line in text.splitlines()] == list(range(1, len(acted) + 1))
    run = json.loads((folder / "run.json").read_text(encoding="utf-8"))
    assert run["episode"]["actions"] == len(acted)
    assert run["episode"]["clean"] is True
    assert run["truth"] == {"in_container": truth.in_container}
    pictures = sorted(folder.glob("step-*.png"))
    assert len(pictures) == len(acted) + 1
    assert all(cv2.imread(str(picture)).std() > 10 for picture in pictures)
    with av.open(str(folder / "video.mp4")) as video:
        frames = [frame.to_ndarray(format="rgb24") for frame in video.decode(video=0)]
    assert len(frames) > 20
    assert frames[0].std() > 10


def test_areas_that_are_gone_are_remembered_without_dirt(
    episode: tuple[list[Event], Truth, Path], domain: Domain
) -> None:
    events, _, _ = episode
    gone = [
        (event.transition, name)
        for event in events
        if isinstance(event, Acted)
        for name in event.transition.arguments
        if name not in {area.name for area in event.situation.areas}
    ]
    assert gone, "nothing was cleaned"
    for transition, name in gone:
        after = {(fact.symbol, fact.objects): fact.value for fact in transition.after}
        assert ("dirt", (name,)) not in after
        assert ("size", (name,)) in after


def test_the_same_seed_sees_the_same(domain: Domain, scene: Scene) -> None:
    def first() -> object:
        with closing(PybulletTable(scene, derived(4, Purpose.WORLD))) as table:
            return look_once(domain, scene, table, 4)

    assert first() == first()


class Stubborn:
    """A robot whose strokes move nothing: every look shows the first one again."""

    def __init__(self, frames: list[Frame], ends: Status = Status.DONE) -> None:
        self._frames = frames
        self._looks = 0
        self._ends = ends
        self._moving = False
        self.clock = 0.0
        self.failure = "something holds it"
        self.stopped = False

    def observe(self) -> Frame:
        self._looks += 1
        return self._frames[self._looks % len(self._frames)]

    def start(self, path: ToolPath) -> None:
        self._moving = True
        self.clock += 5.0

    def withdraw(self) -> None:
        self._moving = False
        self.clock += 1.0

    def poll(self) -> Status:
        return self._ends if self._moving else Status.DONE

    def stop(self) -> None:
        self.stopped = True


@pytest.fixture(scope="module")
def frames(scene: Scene) -> Iterator[list[Frame]]:
    with closing(PybulletTable(scene, derived(1, Purpose.WORLD))) as table:
        yield [table.observe() for _ in range(3)]


def last_of(events: Iterator[Event]) -> Ended:
    (*_, ended) = events
    assert isinstance(ended, Ended)
    return ended


def test_actions_that_do_nothing_end_at_the_limit(domain: Domain, scene: Scene, frames: list[Frame]) -> None:
    options = EpisodeOptions(samples=200, max_actions=5)
    ended = last_of(clean(domain, scene, Stubborn(frames), options))
    assert not ended.clean
    assert ended.actions == 5
    assert "limit of 5 actions" in ended.reason
    assert ended.seconds["acting"] == 25.0


def test_a_robot_that_fails_is_stopped(domain: Domain, scene: Scene, frames: list[Frame]) -> None:
    robot = Stubborn(frames, Status.FAILED)
    ended = last_of(clean(domain, scene, robot, EpisodeOptions(samples=200)))
    assert not ended.clean
    assert "could not carry out" in ended.reason
    assert "something holds it" in ended.reason
    assert robot.stopped


def test_rules_that_promise_nothing_end_the_episode(
    domain: Domain, scene: Scene, frames: list[Frame]
) -> None:
    hopeless = replace(domain, rules=tuple(rule for rule in domain.rules if rule.action == "pickUp"))
    ended = last_of(clean(hopeless, scene, Stubborn(frames), EpisodeOptions(samples=200)))
    assert not ended.clean
    assert "nothing worth doing" in ended.reason


def test_a_one_armed_robot_is_not_asked_to_pick_up(domain: Domain) -> None:
    names = {action.name for action in within_reach(domain, "gantry").actions}
    assert names == {a.name for a in domain.actions} - {"pickUp"}
    assert {rule.action for rule in within_reach(domain, "gantry").rules} == names


def test_no_run_overwrites_another(tmp_path: Path) -> None:
    folders = [free_folder(tmp_path / "runs", "run") for _ in range(3)]
    assert [folder.name for folder in folders] == ["run-001", "run-002", "run-003"]
