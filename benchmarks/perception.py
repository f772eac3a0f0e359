"""How well perception sees, against the truth of 300 simulated tables, and how long its steps take.

    python benchmarks/perception.py [--frames 300] [--clean 500] [--first 0] [--worst FOLDER]

Needs pybullet. Every table has a seed of its own, which draws what lies on it, how it looks, how it is lit,
from where the camera looks, and whether the tool is in view. Its thresholds are those of a calibration on the
same table without dirt, as §3.1 does it. docs/perception.md says what counts as visible, found and right.
"""

from __future__ import annotations

import argparse
import itertools
import sys
from collections.abc import Sequence
from contextlib import closing
from dataclasses import dataclass, replace
from math import cos, pi, radians, sin
from pathlib import Path
from statistics import median

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linear_sum_assignment
from scipy.sparse.csgraph import connected_components
from scipy.spatial.distance import cdist

from cleancli.motion.joint_path import nearest_pose
from cleancli.motion.path import Unreachable
from cleancli.perception import geometry
from cleancli.perception.area import Area, Ellipse
from cleancli.perception.areas import enclosing_ellipses
from cleancli.perception.calibrate import NotClean, calibrate
from cleancli.perception.ellipses import gap
from cleancli.perception.frame import Camera, Frame
from cleancli.perception.perceive import RIM, Observation, perceive
from cleancli.perception.symbols import are_near, is_scattered, lies_between, size_of
from cleancli.scene.calibration import Thresholds
from cleancli.scene.grasps import WIDE
from cleancli.scene.model import (
    CameraSetup,
    Container,
    Dirt,
    Group,
    Ink,
    Light,
    Rag,
    Scattered,
    Scene,
    Surface,
    SymbolThresholds,
)
from cleancli.world import camera as world_camera
from cleancli.world import parameters as par
from cleancli.world.robot import Status
from cleancli.world.table import PybulletTable
from cleancli.world.wam import arm_for

Points = NDArray[np.float64]

SURFACES = {
    "beige": (205, 198, 184),
    "white": (232, 232, 228),
    "grey": (140, 142, 146),
    "wood": (170, 130, 90),
    "dark": (78, 70, 64),
    "blue": (96, 120, 160),
    "green": (120, 150, 120),
}
COLOURS = ((150, 40, 40), (30, 60, 120), (60, 100, 40), (235, 225, 190), (40, 36, 34), (170, 120, 40))
LEAST_CONTRAST = 0.25
"""Dirt is drawn in colours that differ from the surface's by at least this share of its brightness."""
FRAMES_PER_LOOK = 3
CALIBRATION_FRAMES = 5
FOUND = 0.004
"""Metres from a particle's footprint to the middle of a dirty pixel, up to which it is found: two pixels."""
FALSE = 0.008
"""Metres from all dirt above which a patch is false."""


@dataclass(frozen=True)
class Condition:
    """What a table was drawn to be, in words, for the tables."""

    kind: str
    colour: str
    texture: str
    light: str
    noise: str
    tilt: str
    tool: str


@dataclass(frozen=True)
class Result:
    """What came of one table; counts, and errors in metres (infinite for areas that were not found)."""

    seed: int
    condition: Condition
    visible: int
    found: int
    false: int
    areas: tuple[int, int]
    centres: tuple[float, ...]
    symbols: dict[str, tuple[int, int]]
    seconds: dict[str, float]


def main() -> None:
    """Measure, and print the tables; with --worst, write pictures of the 12 worst frames."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--frames", type=int, default=300)
    parser.add_argument("--clean", type=int, default=500)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--worst", type=Path)
    asked = parser.parse_args()
    cv2.setNumThreads(1)
    results = []
    for seed in range(asked.first, asked.first + asked.frames):
        results.append(one(seed, None))
        if sys.stderr.isatty():
            print(f"\r{len(results)} of {asked.frames} tables", end="", file=sys.stderr)
    report(results)
    timing([each.seconds for each in results])
    if asked.clean:
        print(f"clean surfaces: {clean(asked.clean, asked.first)} areas in {asked.clean} frames")
    if asked.worst is not None:
        asked.worst.mkdir(parents=True, exist_ok=True)
        for number, result in enumerate(sorted(results, key=badness, reverse=True)[:12], start=1):
            one(result.seed, asked.worst / f"{number:02}-seed-{result.seed}.png")


def one(seed: int, picture: Path | None) -> Result:
    """Build, calibrate, look, compare."""
    scene, condition, extra = drawn(seed)
    rng = np.random.default_rng([seed, 1])
    scene = calibrated(scene, seed, extra, rng)
    with closing(PybulletTable(scene, seed)) as table:
        if condition.tool == "away":
            withdrawn(table)
        else:
            in_view(table, scene, rng)
        frames = [noisy(table.observe(), extra, rng) for _ in range(FRAMES_PER_LOOK)]
        eye = frames[0].camera
        _, depth = world_camera.render(table._engine, eye, scene.light)
        pieces = [piece for piece in footprints(table) if is_visible(piece.mean(axis=0), eye, depth, scene)]
        everything = footprints(table)
    seen = perceive(frames, scene, rng)
    result = compared(seed, condition, seen, pieces, everything, scene)
    if picture is not None:
        draw(picture, frames[-1], seen, pieces, scene)
    return result


# ---- tables


def drawn(seed: int) -> tuple[Scene, Condition, float]:
    """A scene that the checker accepts, its condition, and the extra noise of colour."""
    rng = np.random.default_rng([seed, 0])
    name = rng.choice(list(SURFACES))
    kind = str(rng.choice(("lentils", "rice", "peas", "ink"), p=(0.4, 0.2, 0.2, 0.2)))
    texture, gradient = float(rng.choice((0.0, 0.0, 0.015, 0.03))), float(rng.choice((0.0, 0.0, 0.15, 0.3)))
    degrees, extra = (0.0, float(rng.uniform(5, 30)))[int(rng.random() < 0.6)], float(rng.choice((0.0, 3.0)))
    tool = {0: "arm", 3: "gantry"}.get(seed % 6, "away")
    top = Surface(0.8, 0.6, 0.45, SURFACES[name], texture=texture, grain=float(rng.uniform(0.01, 0.03)))
    light = Light(rng.uniform(-pi, pi), radians(rng.uniform(45, 85)), rng.uniform(0.5, 0.8), gradient)
    scene = Scene(
        f"table_{seed}",
        top,
        Container("east", 0.0, 0.3, 0.16),
        "wam" if tool == "arm" else "gantry",
        Rag(WIDE, 0.12),
        CameraSetup(0.9, 640, 480, 525),
        layout(kind, top, rng),
        SymbolThresholds(0.05, 0.06, 0.12, 0.14, 0.20, 0.05),
        seed,
        light=light,
    )
    scene = placed(scene, radians(degrees), rng.uniform(-pi, pi))
    lit = "gradient" if gradient else "even"
    slant = "0" if not degrees else "5-18" if degrees < 18 else "18-30"
    texture_word = f"{texture:g}" if texture else "none"
    return scene, Condition(kind, str(name), texture_word, lit, "4.2" if extra else "3", slant, tool), extra


def layout(kind: str, top: Surface, rng: np.random.Generator) -> tuple[Dirt, ...]:
    """One to four groups, and some scattered, of one kind and colour; or lines of ink, and a few lentils."""
    colour = colour_against(kind, top.colour, rng)
    high = top.width / 2 - 0.06, top.depth / 2 - 0.06
    low = -high[0], -high[1]
    if kind == "ink":
        lines = []
        for _ in range(rng.integers(1, 4)):
            start = rng.uniform(low, high)
            end = np.clip(start + rng.uniform(-0.12, 0.12, 2), low, high)
            lines.append(Ink((tuple(start), tuple(end)), float(rng.uniform(0.005, 0.01)), colour))
        return tuple(lines)
    dirt: list[Dirt] = [
        Group(int(rng.integers(4, 16)), tuple(rng.uniform(low, high)), rng.uniform(0.015, 0.04), kind, colour)
        for _ in range(rng.integers(1, 5))
    ]
    if rng.random() < 0.6:
        dirt.append(Scattered(int(rng.integers(3, 20)), low, high, kind, colour))
    return tuple(dirt)


def colour_against(kind: str, ground: tuple[int, int, int], rng: np.random.Generator) -> tuple[int, int, int]:
    """A colour of the kind's own, or another, that can be told from the surface's."""
    own = (par.INK_COLOUR,) if kind == "ink" else par.PARTICLES[kind].colours
    able = [c for c in (*own, *COLOURS) if contrast(c, ground) >= LEAST_CONTRAST]
    return able[int(rng.integers(len(able)))]


def contrast(colour: tuple[int, int, int], ground: tuple[int, int, int]) -> float:
    """As a share of the ground's brightness, root of the mean square of the channels."""
    return float(np.sqrt(np.mean(np.subtract(colour, ground) ** 2)) / np.mean(ground))


def placed(scene: Scene, tilt: float, azimuth: float) -> Scene:
    """The scene with its camera tilted, as near as it sees the whole surface."""
    signs = np.array([(-1, -1), (-1, 1), (1, -1), (1, 1)])
    corners = signs * (scene.surface.width, scene.surface.depth) / 2
    for distance in np.arange(0.85, 3.0, 0.05):
        side = distance * sin(tilt)
        at = (side * cos(azimuth), side * sin(azimuth))
        camera = replace(scene.camera, height=distance * cos(tilt), at=at)
        pixels = geometry.project(world_camera.overhead(camera), corners)
        if (pixels >= 0).all() and (pixels <= (camera.image_width, camera.image_height)).all():
            return replace(scene, camera=camera)
    raise ValueError("no place for the camera")


def calibrated(scene: Scene, seed: int, extra: float, rng: np.random.Generator) -> Scene:
    """The scene with thresholds from its surface without dirt."""
    with closing(PybulletTable(replace(scene, dirt=()), seed)) as table:
        withdrawn(table)
        frames = [noisy(table.observe(), extra, rng) for _ in range(CALIBRATION_FRAMES)]
    try:
        return replace(scene, calibration=calibrate(frames, scene, "drawn", rng))
    except NotClean:
        return scene


def in_view(table: PybulletTable, scene: Scene, rng: np.random.Generator) -> None:
    """The robot with its tool on the surface, or up to 10 cm above it, wherever it reaches."""
    while True:
        x, y = rng.uniform((-0.25, -0.2), (0.25, 0.2))
        point = np.array((x, y, rng.uniform(0.0, 0.1), rng.uniform(-pi, pi)))
        try:
            joints = point if scene.robot == "gantry" else nearest_pose(arm_for(scene), point)
        except Unreachable:
            continue
        table._drive.stand(joints)
        return


def withdrawn(table: PybulletTable) -> None:
    table.withdraw()
    while table.poll() is Status.RUNNING:
        pass


def noisy(frame: Frame, extra: float, rng: np.random.Generator) -> Frame:
    """More noise of colour than the simulated camera has by itself."""
    if not extra:
        return frame
    noise = extra * rng.standard_normal(frame.colour.shape, dtype=np.float32)
    return replace(frame, colour=np.clip(np.round(frame.colour + noise), 0, 255).astype(np.uint8))


# ---- truth


def footprints(table: PybulletTable) -> list[Points]:
    """Points (n, 2) around each particle on the table, seen from above, and around each cell of ink."""
    turns = np.linspace(0, 2 * pi, 16, endpoint=False)
    circle = np.column_stack([np.cos(turns), np.sin(turns)])
    found = []
    kinds = [dirt for dirt in table._scene.dirt for _ in range(getattr(dirt, "count", 0))]
    for body, dirt in zip(table._particles, kinds, strict=True):
        place, turn = table._engine.getBasePositionAndOrientation(body)
        if place[2] < -par.TABLE_THICKNESS / 2:
            continue
        axes = np.array(table._engine.getMatrixFromQuaternion(turn)).reshape(3, 3)[:2]
        half = axes * np.array(par.PARTICLES[dirt.of].size) / 2
        found.append(np.array(place[:2]) + circle @ np.linalg.cholesky(half @ half.T).T)
    square = par.INK_CELL / 2 * np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)])
    return found + [cell[:2] + square for cell in table.truth().ink]


def is_visible(place: Points, eye: Camera, depth: NDArray[np.float32], scene: Scene) -> bool:
    """Whether a place is in the picture, not on the rim, nor behind or just beside what stands on the
    surface."""
    inside = np.abs(place) < np.array((scene.surface.width, scene.surface.depth)) / 2 - RIM - 0.003
    column, row = np.rint(geometry.project(eye, place[None]))[0].astype(int)
    if not inside.all() or not (0 <= column < eye.width and 0 <= row < eye.height):
        return False
    reach = (Thresholds() if scene.calibration is None else scene.calibration.thresholds).object_edge + 2
    around = depth[max(row - reach, 0) : row + reach + 1, max(column - reach, 0) : column + reach + 1]
    rows, columns = np.indices(around.shape)
    pixels = np.column_stack([columns.ravel() + max(column - reach, 0), rows.ravel() + max(row - reach, 0)])
    heights = eye.pose[2, 3] + around.ravel() * geometry.rays(eye, pixels.astype(float))[:, 2]
    return bool(heights.max() < Thresholds().heap)


def true_areas(pieces: Sequence[Points], link: float) -> list[Area]:
    """The areas of §3.1 by their definition: footprints with gaps below `link`, the ellipse around them."""
    if not pieces:
        return []
    owner = np.repeat(np.arange(len(pieces)), [len(piece) for piece in pieces])
    near = cdist(np.vstack(pieces), np.vstack(pieces)) < link
    first, second = np.nonzero(near)
    graph = np.zeros((len(pieces), len(pieces)), np.bool_)
    graph[owner[first], owner[second]] = True
    count, labels = connected_components(graph, directed=False)
    groups = [[pieces[i] for i in np.nonzero(labels == label)[0]] for label in range(count)]
    ellipses = enclosing_ellipses([np.vstack(group) for group in groups])
    return [Area(ellipse, covered(group)) for ellipse, group in zip(ellipses, groups, strict=True)]


def covered(group: Sequence[Points]) -> float:
    """Square metres of the union, on cells of half a millimetre."""
    low = np.vstack(group).min(axis=0)
    size = np.ceil((np.vstack(group).max(axis=0) - low) / 5e-4).astype(int) + 1
    cells = np.zeros((size[1], size[0]), np.uint8)
    for piece in group:
        cv2.fillConvexPoly(cells, np.rint((piece - low) / 5e-4).astype(np.int32), 1)
    # The polygon filled reaches half a cell beyond its corners on each side: about 1 % of a lentil's width.
    return float(cells.sum()) * 2.5e-7


# ---- comparison


def compared(
    seed: int,
    condition: Condition,
    seen: Observation,
    pieces: Sequence[Points],
    everything: Sequence[Points],
    scene: Scene,
) -> Result:
    """Counts and errors of one table."""
    middles, patches = dirty(seen)
    found = sum(bool(len(middles) and cdist(piece, middles).min() < FOUND) for piece in pieces)
    all_dirt = np.vstack(everything) if everything else np.full((1, 2), np.inf)
    false = sum(cdist(patch, all_dirt).min() > FALSE for patch in patches)
    true = true_areas(pieces, scene.symbols.link)
    pairs = matched(true, seen.areas)
    errors = [float(np.hypot(*np.subtract(t.ellipse.centre, s.ellipse.centre))) for t, s in pairs]
    errors += [float("inf")] * (len(true) - len(pairs))
    return Result(
        seed,
        condition,
        len(pieces),
        found,
        int(false),
        (len(true), len(seen.areas)),
        tuple(errors),
        agreement(pairs, scene),
        dict(seen.seconds),
    )


def dirty(seen: Observation) -> tuple[Points, list[Points]]:
    """The places of all dirty pixels, (n, 2), and those of each patch."""
    mask = seen.steps.believed
    count, labels = cv2.connectedComponents(mask.view(np.uint8), connectivity=8)
    rows, columns = np.nonzero(mask)
    pixels = np.column_stack([columns, rows]).astype(float)
    places = geometry.on_plane(seen.camera, LEVEL, pixels) if len(pixels) else np.empty((0, 2))
    of = labels[rows, columns]
    return places, [places[of == label] for label in range(1, count)]


LEVEL = geometry.Plane.below(np.zeros(3), np.array([0.0, 0.0, 1.0]), 0.0, np.array([1.0, 0.0, 0.0]))


def matched(true: Sequence[Area], seen: Sequence[Area]) -> list[tuple[Area, Area]]:
    """Pairs that mean the same dirt: all together at the least distances, none across more than 3 cm."""
    if not true or not seen:
        return []
    apart = cdist([a.ellipse.centre for a in true], [a.ellipse.centre for a in seen])
    rows, columns = linear_sum_assignment(apart)
    pairs = [(true[r], seen[c]) for r, c in zip(rows, columns, strict=True)]
    return [(t, s) for t, s in pairs if gap(t.ellipse, s.ellipse) <= 0.03]


def agreement(pairs: Sequence[tuple[Area, Area]], scene: Scene) -> dict[str, tuple[int, int]]:
    """By symbol, how often both say the same, and how often that was asked. Of `near` and `traversal`, only
    where at least one of both says yes: else all that is far apart would count."""
    limits = scene.symbols
    size = [size_of(t, limits) == size_of(s, limits) for t, s in pairs]
    scattered = [is_scattered(t, limits) == is_scattered(s, limits) for t, s in pairs]
    near = [
        tuple(are_near(a[side].ellipse, b[side].ellipse, limits) for side in (0, 1))
        for a, b in itertools.combinations(pairs, 2)
    ]
    between = [
        tuple(
            lies_between(m[s].ellipse.centre, a[s].ellipse.centre, b[s].ellipse.centre, limits.traversal)
            for s in (0, 1)
        )
        for a, b, m in itertools.permutations(pairs, 3)
    ]
    said = {"near": near, "traversal": between}
    return (
        {"size": (sum(size), len(size)), "scattered": (sum(scattered), len(scattered))}
        | {
            name: (sum(t == s for t, s in both if t or s), sum(t or s for t, s in both))
            for name, both in said.items()
        }
        | {f"{name}, all": (sum(t == s for t, s in both), len(both)) for name, both in said.items()}
    )


# ---- reports


def report(results: Sequence[Result]) -> None:
    """A row for all tables and one for each value of each condition, then the symbols."""
    head = f"{'condition':22}{'tables':>7}{'visible':>8}{'missed':>7}{'false':>6}{'recall':>8}{'precis.':>8}"
    print(head + f"{'count±1':>8}{'median':>8}{'95 %':>8}  mm")
    print(row("all", results))
    for name in Condition.__annotations__:
        for value in sorted({getattr(each.condition, name) for each in results}):
            print(row(f"{name} {value}", [r for r in results if getattr(r.condition, name) == value]))
    for symbol in results[0].symbols:
        same, asked = (sum(r.symbols[symbol][i] for r in results) for i in (0, 1))
        print(f"{symbol:16} {same:6} of {asked:6} agree: {same / max(asked, 1):.3f}")


def row(name: str, results: Sequence[Result]) -> str:
    visible, found, false = (sum(getattr(r, key) for r in results) for key in ("visible", "found", "false"))
    right = np.mean([abs(r.areas[0] - r.areas[1]) <= 1 for r in results])
    errors = np.sort([error for r in results for error in r.centres])
    middle, high = (errors[int(share * (len(errors) - 1))] if len(errors) else 0.0 for share in (0.5, 0.95))
    recall, precision = found / max(visible, 1), found / max(found + false, 1)
    counts = f"{name:22}{len(results):7}{visible:8}{visible - found:7}{false:6}{recall:8.4f}{precision:8.4f}"
    return f"{counts}{right:8.3f}{1e3 * middle:8.2f}{1e3 * high:8.2f}"


def badness(result: Result) -> float:
    """How bad a table is seen: particles missed, patches made up, areas too many or too few, centres off."""
    missing = result.visible - result.found
    far = sum(min(error, 0.1) for error in result.centres)
    return missing + 3 * result.false + 2 * abs(result.areas[0] - result.areas[1]) + 20 * far


def timing(looks: Sequence[dict[str, float]]) -> None:
    """Milliseconds by step; steps that are done for every frame are given for one."""
    print(f"{'step':12}{'median':>8}{'95 %':>8}  ms a frame")
    each = {"surface", "edges", "background", "median"}
    totals = np.zeros(len(looks))
    for step in looks[0]:
        values = 1e3 * np.array([look[step] for look in looks]) / (FRAMES_PER_LOOK if step in each else 1)
        totals += values
        print(f"{step:12}{median(values):8.2f}{np.quantile(values, 0.95):8.2f}")
    print(f"{'total':12}{median(totals):8.2f}{np.quantile(totals, 0.95):8.2f}")


def clean(count: int, first: int) -> int:
    """How many areas are seen in frames of clean surfaces, 25 of each table, every frame by itself."""
    areas = 0
    for number in range(-(-count // 25)):
        scene, _, extra = drawn(first + 10_000 + number)
        rng = np.random.default_rng([first + number, 2])
        scene = calibrated(scene, first + number, extra, rng)
        with closing(PybulletTable(replace(scene, dirt=()), first + number + 1)) as table:
            withdrawn(table)
            for _ in range(min(25, count - 25 * number)):
                areas += len(perceive([noisy(table.observe(), extra, rng)], scene, rng).areas)
    return areas


def draw(path: Path, frame: Frame, seen: Observation, pieces: Sequence[Points], scene: Scene) -> None:
    """The frame with true ellipses in green, seen ones in red, and particles that were missed in yellow."""
    picture = cv2.cvtColor(frame.colour, cv2.COLOR_RGB2BGR)
    for areas, colour in ((true_areas(pieces, scene.symbols.link), (0, 160, 0)), (seen.areas, (0, 0, 220))):
        for area in areas:
            outline = geometry.project(frame.camera, boundary(area.ellipse))
            cv2.polylines(picture, [np.rint(outline).astype(np.int32)[:, None]], True, colour, 1, cv2.LINE_AA)
    middles, _ = dirty(seen)
    for piece in pieces:
        if not len(middles) or cdist(piece, middles).min() >= FOUND:
            column, line = np.rint(geometry.project(frame.camera, piece.mean(axis=0)[None]))[0].astype(int)
            cv2.circle(picture, (int(column), int(line)), 6, (0, 220, 255), 1, cv2.LINE_AA)
    cv2.imwrite(str(path), picture)


def boundary(ellipse: Ellipse) -> Points:
    turns = np.linspace(0, 2 * pi, 48, endpoint=False)
    east, north = cos(ellipse.angle), sin(ellipse.angle)
    local = np.column_stack([ellipse.axes[0] * np.cos(turns), ellipse.axes[1] * np.sin(turns)])
    return local @ np.array([[east, north], [-north, east]]) + np.array(ellipse.centre)


if __name__ == "__main__":
    main()
