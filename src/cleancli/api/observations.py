"""What is seen on a scene's table or in recorded frames: areas, symbols, and a picture of the last look."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from contextlib import closing
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from cleancli.api.checks import check_least, check_seconds
from cleancli.api.inputs import GivenDomain, load_domain, source_of
from cleancli.api.plain import plain
from cleancli.api.tables import preformatted
from cleancli.array_types import Image
from cleancli.execution.seeds import Stream, derived
from cleancli.geometry.rgbd import Frame
from cleancli.language.diagnostics.plural import plural
from cleancli.language.load import located_in
from cleancli.language.model import Domain, State
from cleancli.perception.area import Area
from cleancli.perception.frame_source import BadRecording
from cleancli.perception.look import FRAMES_PER_LOOK, Look, look_at
from cleancli.perception.perceive import BadFrame
from cleancli.perception.pictures import draw, with_doubts
from cleancli.perception.reading import EVERY, MAX_DIFFERENCE, Reading
from cleancli.perception.sources import is_recording, recorded_looks
from cleancli.perception.surface import NoSurface
from cleancli.recording.pictures import png_of
from cleancli.scene.check import load_scene
from cleancli.scene.model import Scene
from cleancli.scene.robots import REMOTE

TOLD = 12
"""Facts of one symbol up to which a person is told each; of 26 areas, 700 lie between two others."""


@dataclass(frozen=True, slots=True)
class ObservationResult:
    """What each look shows, as docs/python.md lists it; `png` is a picture of the last one, `doubts` what
    speaks against how the camera and the surface are described, `notes` what of a recording is left out."""

    looks: tuple[Mapping[str, object], ...]
    doubts: tuple[str, ...]
    notes: tuple[str, ...]
    png: bytes
    text: str

    def to_dict(self) -> dict[str, object]:
        """The same as `cleancli perceive --json` prints."""
        return {"looks": plain(self.looks), "notes": list(self.notes)}

    def __str__(self) -> str:
        return self.text

    def __repr__(self) -> str:
        return f"<observation of {plural(len(self.looks), 'look')}>"

    def _repr_png_(self) -> bytes:
        return self.png

    def _repr_html_(self) -> str:
        return preformatted(self.text)


def perceive(
    scene_or_folder: str | Path,
    *,
    scene: str | Path = "two_groups",
    domain: GivenDomain | None = None,
    seed: int | None = None,
    frame: str | None = None,
    colour_topic: str | None = None,
    depth_topic: str | None = None,
    info_topic: str | None = None,
    max_difference: float = MAX_DIFFERENCE,
    every: float = EVERY,
) -> ObservationResult:
    """What perception sees of the table of a scene (a name, a path or a text), or in recorded frames (a
    folder or a bag), which are understood with the surface and the thresholds of `scene`; all after `seed`
    says how a recording is read.

    Raises Refused for mistakes in the texts, ValueError for options that make no sense, OSError for frames
    that cannot be read, MissingBags without rosbags.
    """
    check_least(0, seed=seed)
    check_seconds("max_difference", max_difference, none_of_it=True)
    check_seconds("every", every, none_of_it=False)
    given = str(scene_or_folder)
    is_recorded = "{" not in given and is_recording(Path(given))
    setting = load_scene(source_of(scene if is_recorded else scene_or_folder, "problem"))
    loaded = load_domain(setting.domain if domain is None else domain)
    seed = setting.seed if seed is None else seed
    notes: tuple[str, ...] = ()
    if is_recorded:
        reading = Reading(frame, colour_topic, depth_topic, info_topic, max_difference, every)
        sets, notes = recorded_looks(Path(given), reading)
    else:
        sets = iter([(setting.name, photographed(setting, seed))])
    looks, lines, last = list[Mapping[str, object]](), list[str](), None
    with located_in(*loaded.sources):
        for last in understood(sets, setting, loaded.model, seed):
            looks.append(described(last))
            lines += told(last)
    assert last is not None, "a folder without frames is refused"
    return ObservationResult(
        tuple(looks), tuple(last.look.observation.doubts), notes, png_of(drawn(last.look)), "\n".join(lines)
    )


def drawn(look: Look) -> Image:
    """The colour image with ellipses, names and symbols, and doubts below it; RGB."""
    frame = replace(look.frames[-1], camera=look.observation.camera)
    return with_doubts(draw(frame, look.areas, look.state), look.observation.doubts)


@dataclass(frozen=True, slots=True)
class SeenLook:
    """A look, and where its frames come from."""

    source: str
    look: Look


def photographed(setting: Scene, seed: int) -> tuple[Frame, ...]:
    """The scene's simulated table with the tool at rest, or a remote robot's as it is. Either is imported
    here: recorded frames need neither."""
    if setting.robot == REMOTE:
        from cleancli.remote.robot import RemoteRobot

        with RemoteRobot(setting.driver) as robot:
            return tuple(robot.observe() for _ in range(FRAMES_PER_LOOK))
    from cleancli.world.table import PybulletTable

    with closing(PybulletTable(setting, derived(seed, Stream.WORLD))) as table:
        return tuple(table.observe() for _ in range(FRAMES_PER_LOOK))


def understood(
    sets: Iterable[tuple[str, tuple[Frame, ...]]],
    setting: Scene,
    domain: Domain,
    seed: int,
) -> Iterator[SeenLook]:
    """What each look shows; areas that are hidden in one stay as they were in the look before."""
    rng = np.random.default_rng(derived(seed, Stream.PERCEPTION))
    areas: tuple[Area, ...] = ()
    next_number = 1
    for source, frames in sets:
        try:
            look = look_at(frames, setting, domain, rng, areas, None, next_number)
        except (BadFrame, NoSurface) as error:
            raise BadRecording(f"{source}: {error}") from error
        areas, next_number = look.areas, look.known.next_number
        yield SeenLook(source, look)


def described(seen: SeenLook) -> dict[str, object]:
    """Lengths in metres and square metres, angles in radians, times in seconds."""
    unseen = seen.look.known.unseen
    return {
        "source": seen.source,
        "clock": seen.look.frames[-1].clock,
        "areas": [_area(area, seen) for area in seen.look.areas],
        "left_out": seen.look.left_out,
        "in_zone": None if (arrived := seen.look.observation.arrived) is None else round(arrived, 4),
        "facts": _facts(seen.look.state),
        "doubts": list(seen.look.observation.doubts),
        "changes": [str(change) for change in seen.look.known.changes],
        "unseen": {
            "share": round(unseen.share, 4),
            "outlines": [[[round(x, 4), round(y, 4)] for x, y in outline] for outline in unseen.outlines()],
        },
    }


def _area(area: Area, seen: SeenLook) -> dict[str, object]:
    alone = {
        fact.symbol: fact.value
        for fact in sorted(seen.look.state)
        if fact.objects == (area.name,) and fact.symbol != "dirt"
    }
    return {
        "area": area.name,
        "at": [round(place, 4) for place in area.ellipse.centre],
        "diameters": [round(2 * axis, 4) for axis in area.ellipse.axes],
        "angle": round(area.ellipse.angle, 4),
        "covered": round(area.covered, 6),
        "hidden": round(seen.look.known.hidden[area.name], 3),
        **alone,
    }


def _facts(state: State) -> dict[str, list[list[str]]]:
    """Symbol -> the areas and things for which it holds, of those that are about more than one."""
    facts: dict[str, list[list[str]]] = {}
    for fact in sorted(fact for fact in state if len(fact.objects) > 1):
        facts.setdefault(fact.symbol, []).append(list(fact.objects))
    return facts


def told(seen: SeenLook) -> Iterator[str]:
    areas, unseen = seen.look.areas, seen.look.known.unseen.share
    hidden = f", {unseen:z.0%} of the surface unseen" if unseen >= 0.005 else ""
    yield f"{seen.source}: {plural(len(areas), 'area')}{hidden}"
    yield from (f"  {change}" for change in seen.look.known.changes)
    yield from (f"  {_line(area, seen)}" for area in areas)
    if seen.look.observation.arrived is not None:
        yield f"  in the zone: {seen.look.observation.arrived:z.0%} of the dirt that is seen"
    if seen.look.left_out:
        yield f"  left out of plans: {', '.join(seen.look.left_out)}"
    for symbol, holds in _facts(seen.look.state).items():
        told = ", ".join(f"({' '.join(objects)})" for objects in holds)
        yield f"  {symbol}: {told if len(holds) <= TOLD else f'{len(holds)} times; --json tells where'}"


def _line(area: Area, seen: SeenLook) -> str:
    (x, y), (long, short) = area.ellipse.centre, area.ellipse.axes
    told = _area(area, seen)
    said = [str(told["size"])] if "size" in told else []
    said += [name for name, value in told.items() if value is True]
    if share := seen.look.known.hidden[area.name]:
        said.append("remembered" if share == 1 else f"{share:z.0%} hidden")
    words = "".join(f", {word}" for word in said)
    return f"{area.name}: at ({_cm(x)}, {_cm(y)}) cm, {_cm(2 * long)} x {_cm(2 * short)} cm{words}"


def _cm(metres: float) -> str:
    return f"{metres * 100:z.1f}".removesuffix(".0")
