"""Whether areas keep their names: python benchmarks/identity.py [pushes] [--seed N] [--keep FILE]

Random layouts of lentils, rice and peas, random actions of the gantry upon areas that perception found, those
of a join `near` each other, and one look with the tool withdrawn before and after each. Truth comes from the
particles, which have identities.

A particle belongs to the area in whose ellipse it lies, or within 5 mm of it; of several, to the nearest. An
area's heir is the area that holds most of its particles after the push; if several do, the one of its name.
An area is matched right if

- it has no heir, since nothing of it is seen any more, and its name is given to none;
- its heir has its name; or
- its heir has the name of another area with the same heir, and a merge record says that both became it; its
  own name may then go on with particles of it that were left behind, and with nothing else.

`moved` areas are those with a particle that moved by a centimetre or more: the rest is easy. A split is true
where an area that is nobody's heir has particles of an area before: it split from that which most come from.
Exit code 1 where fewer than 0.97 of the areas are matched right.

100 pushes take about ten minutes of CPU. Each layout has a line of its own as soon as it is done, and with
--keep a line of FILE: what stands there is not done again.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator
from contextlib import closing
from dataclasses import asdict, dataclass
from itertools import islice, pairwise, permutations
from pathlib import Path

import numpy as np
from kept import Kept

from cleancli.array_types import Longs, Points
from cleancli.geometry.ellipse import boundary, contains
from cleancli.language.diagnostics.diagnostic import Source
from cleancli.motion.actions import SKILLS, tool_path
from cleancli.perception.area import Area
from cleancli.perception.perceive import perceive
from cleancli.perception.symbols import are_near
from cleancli.perception.tracking import Merge, Split, Stroke, Tracked, track
from cleancli.scene.check import load_scene
from cleancli.scene.model import Scene
from cleancli.world.robot import Status, finish
from cleancli.world.table import PybulletTable

GOAL = 0.97
ROUND = 5
"""Pushes upon one layout."""

AROUND = 0.005  # metres around an ellipse in which a particle is still its area's
MOVED = 0.010  # metres by which a particle has moved


@dataclass(frozen=True)
class Push:
    """One action: the named areas before, the unnamed ones after, and all particles (n, 2) at both times, NaN
    where they are not on the table."""

    action: str
    stroke: Stroke
    before: tuple[Area, ...]
    after: tuple[Area, ...]
    places_before: Points
    places_after: Points


@dataclass(frozen=True)
class Score:
    """Areas matched right, and how many there were: all, and those that moved. Of splits and merges, how many
    were both named and true, named, and true."""

    action: str
    areas: tuple[int, int]
    moved: tuple[int, int]
    splits: tuple[int, int, int]
    merges: tuple[int, int, int]


def layout(rng: np.random.Generator) -> Scene:
    """A scene with one to four groups and some scattered particles, the container at any edge."""
    kinds = ("lentils", "rice", "peas")
    dirt = []
    for _ in range(rng.integers(1, 5)):
        x, y = rng.uniform((-36, -26), (36, 26))
        count, radius, of = rng.integers(4, 14), rng.uniform(2, 5), rng.choice(kinds)
        dirt.append(
            f"group {{ count = {count} of = {of} at = ({x:.1f} cm, {y:.1f} cm) radius = {radius:.1f} cm }}"
        )
    count, of = rng.integers(4, 20), rng.choice(kinds)
    dirt.append(f"scattered {{ count = {count} of = {of} from = (-36 cm, -26 cm) to = (36 cm, 26 cm) }}")
    edge = rng.choice(("north", "east", "south", "west"))
    return load_scene(
        Source("layout", f"scene layout {{ container {{ edge = {edge} }} dirt {{ {' '.join(dirt)} }} }}")
    )


def scores(number: int, seed: int, kept: Kept) -> list[Score]:
    """Those of so many random pushes, `ROUND` upon each layout; a line is printed for each layout."""
    known = {(row["seed"], row["layout"], row["most"]): row["scores"] for row in kept.rows()}
    found: list[Score] = []
    for table in range(10 * number):
        key = seed, table, min(ROUND, number - len(found))
        if key not in known:
            known[key] = [asdict(judged(push)) for push in islice(pushes(seed, table), key[2])]
            kept.add({"seed": seed, "layout": table, "most": key[2], "scores": known[key]})
        own = [Score(**score) for score in known[key]]
        found += own
        right, there = (sum(score.areas[i] for score in own) for i in (0, 1))
        print(f"layout {table}: {len(own)} pushes, {right} of {there} areas matched right", flush=True)
        if len(found) == number:
            break
    return found


def pushes(seed: int, number: int) -> Iterator[Push]:
    """Random pushes upon one layout."""
    rng = np.random.default_rng([seed, number])
    scene = layout(rng)
    with closing(PybulletTable(scene, int(rng.integers(2**31)))) as table:
        yield from _round(table, scene, rng)


def judged(push: Push) -> Score:
    """What `track` makes of a push, held against the particles."""
    return judge(push, track(push.before, push.after, push.stroke, 1000))


def _round(table: PybulletTable, scene: Scene, rng: np.random.Generator) -> Iterator[Push]:
    next_number = 1
    areas: tuple[Area, ...] = ()
    stroke, action, places_before = None, "", np.empty((0, 2))
    _finish(table, table.withdraw)
    for _ in range(ROUND + 1):
        seen = perceive([table.observe() for _ in range(3)], scene, rng).areas
        places = _on_table(table)
        if stroke is not None:
            yield Push(action, stroke, areas, seen, places_before, places)
        tracked = track(areas, seen, stroke, next_number)
        areas, next_number = tracked.areas, tracked.next_number
        actions = {name: list(chains(areas, skill.arity, scene)) for name, skill in sorted(SKILLS.items())}
        possible = [name for name, chosen in actions.items() if chosen]
        if not possible:
            return
        action = str(rng.choice(possible))
        chosen = actions[action][rng.integers(len(actions[action]))]
        path = tool_path(action, tuple(area.ellipse for area in chosen), scene)
        places_before = places
        _finish(table, lambda path=path: table.start(path))
        _finish(table, table.withdraw)
        points = tuple((w.x, w.y) for w in path.waypoints if w.z <= 0)
        stroke = Stroke(tuple(area.name for area in chosen), points, scene.rag.width / 2)


def chains(areas: tuple[Area, ...], arity: int, scene: Scene) -> Iterator[tuple[Area, ...]]:
    """What an action can be done upon: different areas, each `near` the one before, as joins ask (§3.2.3)."""
    for chosen in permutations(areas, arity):
        if all(are_near(a.ellipse, b.ellipse, scene.symbols) for a, b in pairwise(chosen)):
            yield chosen


def _finish(table: PybulletTable, begin) -> None:  # type: ignore[no-untyped-def]
    begin()
    if finish(table) is Status.FAILED:
        table.stop()


def _on_table(table: PybulletTable) -> Points:
    truth = table.truth()
    places = truth.positions[:, :2].copy()
    left = {tuple(place) for place in truth.left.tolist()}
    places[[tuple(place) not in left for place in truth.positions.tolist()]] = np.nan
    return places


def owners(areas: tuple[Area, ...], places: Points) -> Longs:
    """For each particle the index of its area, -1 for none."""
    owner = np.full(len(places), -1)
    nearest = np.full(len(places), np.inf)
    known = np.isfinite(places).all(axis=1)
    for index, area in enumerate(areas):
        rim = boundary(area.ellipse)
        away = np.full(len(places), np.inf)
        away[known] = np.hypot(*(places[known, None, :] - rim[None, ::6, :]).transpose(2, 0, 1)).min(axis=1)
        away[known] *= np.where(contains(area.ellipse, places[known]), -1, 1)
        closer = (away < AROUND) & (away < nearest)
        owner[closer], nearest[closer] = index, away[closer]
    return owner


def judge(push: Push, tracked: Tracked) -> Score:
    """Tracking's names held against the particles."""
    old, new = owners(push.before, push.places_before), owners(push.after, push.places_after)
    flow = np.zeros((len(push.before), len(push.after)), int)
    both = (old >= 0) & (new >= 0)
    np.add.at(flow, (old[both], new[both]), 1)
    # Of several that hold as many, the one with its name.
    own = np.array([[old.name == new.name for new in tracked.areas] for old in push.before]).reshape(
        flow.shape
    )
    heirs = {i: int((row + own[i] / 2).argmax()) for i, row in enumerate(flow) if row.any()}
    far = np.hypot(*(push.places_after - push.places_before).T)
    names = [area.name for area in tracked.areas]
    merged = {(of, c.into) for c in tracked.changes if isinstance(c, Merge) for of in c.of if of != c.into}
    right, moved_right, moved = 0, 0, 0
    for i, area in enumerate(push.before):
        heir = heirs.get(i)
        if heir is None:
            fits = area.name not in names
        else:
            sharing = {push.before[j].name for j, h in heirs.items() if h == heir}
            name = names[heir]
            fits = name == area.name or (name in sharing and (area.name, name) in merged)
            bearer = names.index(area.name) if area.name in names else heir
            fits = fits and bool(flow[i, bearer] or not flow[:, bearer].any())
        right += fits
        # What has left the table has moved, too.
        if not (far[old == i] < MOVED).all():
            moved, moved_right = moved + 1, moved_right + fits
    return Score(
        push.action,
        (right, len(push.before)),
        (moved_right, moved),
        _splits(push, tracked, flow, heirs),
        _merges(push, tracked, heirs, merged),
    )


def _splits(push: Push, tracked: Tracked, flow: Longs, heirs: dict[int, int]) -> tuple[int, int, int]:
    names = [area.name for area in tracked.areas]
    true = set()
    for j in range(len(push.after)):
        if flow[:, j].any() and j not in heirs.values():
            of = push.before[int(flow[:, j].argmax())].name
            true |= {(of, names[j])} - {(of, of)}
    named = {(c.of, into) for c in tracked.changes if isinstance(c, Split) for into in c.into if into != c.of}
    return len(true & named), len(named), len(true)


def _merges(
    push: Push, tracked: Tracked, heirs: dict[int, int], merged: set[tuple[str, str]]
) -> tuple[int, int, int]:
    names = [area.name for area in tracked.areas]
    true = {(push.before[i].name, names[h]) for i, h in heirs.items() if list(heirs.values()).count(h) > 1}
    true = {(of, into) for of, into in true if of != into}
    return len(true & merged), len(merged), len(true)


def main() -> int:
    """Print the figures; the exit code."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("pushes", type=int, nargs="?", default=100)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--keep", type=Path, metavar="FILE", help="layouts done before are in it")
    options = parser.parse_args()
    share = report(scores(options.pushes, options.seed, Kept(options.keep)))
    return 0 if share >= GOAL else 1


def report(scores: list[Score]) -> float:
    """Print a table; the share of areas matched right."""
    areas, moved, splits, merges = (
        np.sum([getattr(score, name) for score in scores], axis=0)
        for name in ("areas", "moved", "splits", "merges")
    )
    whole = sum(score.areas[0] == score.areas[1] for score in scores)
    print(f"areas matched right    {areas[0]:5} of {areas[1]:5}  {areas[0] / max(1, areas[1]):.3f}")
    print(f"  of those that moved  {moved[0]:5} of {moved[1]:5}  {moved[0] / max(1, moved[1]):.3f}")
    print(f"pushes without mistake {whole:5} of {len(scores):5}  {whole / max(1, len(scores)):.3f}")
    for action in sorted(SKILLS):
        of = np.array([score.areas for score in scores if score.action == action]).reshape(-1, 2)
        found, there = of.sum(axis=0)
        print(f"  {action:23} {found:5} of {there:5}  {found / max(1, there):.3f}, {len(of)} times")
    for what, (both, named, true) in (("splits", splits), ("merges", merges)):
        print(f"{what}: {named} named, {both} of them true; {true} true")
    return float(areas[0] / max(1, areas[1]))


if __name__ == "__main__":
    sys.exit(main())
