"""benchmarks/bound.py: the least time that strokes over true positions need, and what a gap is made of."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import replace
from itertools import chain, combinations
from math import inf
from pathlib import Path

import bound
import numpy as np
import pytest
from bound_replay import Unhidden, carried_out, is_sound, layout_of, without_errors
from bound_search import quickest
from bound_strokes import Layout, Stroke, nearest_pushes, possible, straight_pushes, stroke, undominated
from strategies import Row

from cleancli.execution.kinematic_cell import KinematicCell
from cleancli.execution.seeds import Stream, derived
from cleancli.geometry.ellipse import Ellipse
from cleancli.motion.actions import past_edge, path_along
from cleancli.motion.way_out import way_out
from cleancli.scene.model import Scattered
from cleancli.world import constants as par
from cleancli.world.kinematic import KinematicTable
from cleancli.world.robot import finish
from support.shipped import shipped_domain, shipped_scene

SCENE = shipped_scene("scattered_40")
FEW = replace(SCENE, dirt=(Scattered(9, (-0.35, -0.25), (0.35, 0.25)),))


def best_by_force(strokes: Sequence[Stroke], count: int) -> float:
    """Seconds of the quickest strokes that take all, by trying all choices of at most `count`, and every one
    of them first."""
    least = inf
    for some in chain.from_iterable(combinations(strokes, size) for size in range(1, count + 1)):
        takes = 0
        for one in some:
            takes |= one.takes
        if takes == (1 << count) - 1:
            seconds = sum(one.seconds for one in some)
            least = min(least, *(seconds - one.seconds + one.first for one in some))
    return least


def test_the_integer_program_chooses_as_all_choices_tried() -> None:
    rng = np.random.default_rng(4)
    for _ in range(10):
        count = int(rng.integers(1, 5))
        strokes = [
            Stroke((), int(takes), *rng.uniform(3, 9, 2).tolist())
            for takes in (*rng.integers(1, 1 << count, 9), (1 << count) - 1)
        ]
        assert quickest(undominated(strokes), count).seconds == pytest.approx(best_by_force(strokes, count))
    with pytest.raises(ValueError, match="no choice"):
        quickest([Stroke((), 1, 1.0, 1.0)], 2)


def test_a_clean_table_takes_no_time() -> None:
    assert quickest([], 0).seconds == 0.0


def test_no_straight_pushes_are_quicker_than_the_candidates() -> None:
    """Thousands of others, drawn anywhere: three particles, so that all choices can be tried."""
    (x0, y0), (x1, y1) = SCENE.mouth()
    for seed in range(2):
        rng = np.random.default_rng(seed)
        layout = Layout(SCENE, seed, rng.uniform((-0.3, -0.15), (0.3, 0.15), (3, 2)))
        drawn = []
        for _ in range(4000):
            start = layout.places[rng.integers(3)] + rng.uniform(-0.06, 0.06, 2)
            share = rng.random()
            begin, crossing = tuple(start.tolist()), (x0 + share * (x1 - x0), y0 + share * (y1 - y0))
            if possible((begin,), crossing, SCENE):
                drawn.append(stroke((begin, past_edge(begin, crossing, SCENE)), layout))
        least = best_by_force(undominated(drawn), 3)
        found = quickest(undominated([*nearest_pushes(layout), *straight_pushes(layout)]), 3).seconds
        assert found - 0.05 < least < found + 0.5


def test_what_a_straight_stroke_is_said_to_take_the_stand_in_takes() -> None:
    layout = layout_of(SCENE, 5)
    strokes = list(straight_pushes(layout))
    for one in strokes[:: len(strokes) // 8]:
        assert is_sound(one, layout)


def test_the_ways_of_the_skill_are_possible() -> None:
    """Where they go straight: a push from beside the mouth turns by more than a stroke of the bound may."""
    for x, y in np.random.default_rng(2).uniform((-0.4, -0.3), (0.3, 0.3), (30, 2)).tolist():
        others = (Ellipse((0.2, 0.1), (0.01, 0.01), 0.0), Ellipse((0.1, -0.2), (0.01, 0.01), 0.0))
        way = way_out((x, y), SCENE, others)
        if len(way.corners) == 2:
            assert possible(way.corners[:1], way.corners[1], SCENE)
    assert not possible(((0.44, 0.0),), (0.45, 0.1), SCENE), "slants too much"
    assert not possible(((0.0, 0.15),), (0.45, 0.15), SCENE), "an end of the rag passes beside the mouth"
    assert not possible(((0.0, 0.0), (0.3, 0.1), (0.2, -0.1)), (0.45, 0.0), SCENE), "turns too sharply"


def test_strokes_of_the_bound_clean_the_table_in_about_the_time_said() -> None:
    """docs/measurements/execution.md: carried out on the stand-in they take a bit more than plans expect."""
    layout = layout_of(FEW, 3)
    told = bound.bound(layout, bends=2, steps=400)
    assert told["bending"]["least"] <= told["free"]["least"] <= told["nearest"]["least"]
    for kind in ("nearest", "free", "bending"):
        assert told[kind]["left"] == 0
        assert told[kind]["least"] < told[kind]["seconds"] < 1.1 * told[kind]["least"]
    assert told["bending"]["seconds"] < 0.9 * told["free"]["seconds"], "lentils so far apart ask for bends"


def test_a_stroke_that_loses_what_it_should_take_is_not_sound() -> None:
    layout = layout_of(FEW, 3)
    start = tuple(layout.places[0].tolist())
    one = stroke((start, (0.5, 0.0)), layout)
    assert is_sound(one, layout)
    assert not is_sound(replace(one, takes=(1 << 9) - 1), layout)
    assert carried_out((one,), layout)[1] == 9 - one.takes.bit_count()


def test_errors_are_off_for_a_while_and_nothing_is_hidden_from_looks() -> None:
    before = par.HEIGHT_NOISE, par.SIDE_NOISE, par.YAW_NOISE
    with without_errors():
        assert (par.HEIGHT_NOISE, par.SIDE_NOISE, par.YAW_NOISE) == (0, 0, 0)
    assert before == (par.HEIGHT_NOISE, par.SIDE_NOISE, par.YAW_NOISE)
    domain, shares = shipped_domain("cleaning"), []
    for kind in (KinematicTable, Unhidden):
        table = kind(SCENE, derived(5, Stream.WORLD))
        table.start(path_along(((-0.2, 0.0), (0.0, 0.0)), SCENE))
        finish(table)
        shares.append(KinematicCell(domain, SCENE, table).look(None, None, 0, 0).situation.hidden)
    assert shares[0] > shares[1] == 0


def row(seed: int, seconds: float, clean: bool = True) -> Row:
    return {
        "job": ["cleaning", "scattered_40", "plan-2", seed],
        "clean": clean,
        "seconds": {"transits": seconds / 2, "actions": seconds / 2},
    }


def test_the_parts_of_a_gap_add_up_and_dirty_tables_are_left_out() -> None:
    assert sum(bound.parts(80, (70, 65, 60), 40).values()) == 40
    episodes = [row(1, 80), row(2, 60), row(3, 90)]
    played = [row(1, 70), row(1, 65), row(1, 60), row(2, 70), row(2, 65), row(2, 60)]
    played += [row(3, 70, clean=False), row(3, 65), row(3, 60)]
    found = [{"table": ["scattered_40", n, 3, 1], "bending": {"seconds": 40.0}} for n in (1, 2, 3)]
    rows = [[c.strip() for c in line.split("|")[1:-1]] for line in bound.gap_lines(episodes, played, found)]
    assert rows[0][4:] == list(bound.PARTS)
    assert rows[2][2:] == ["80.0", "40.0", "10.0", "5.0", "5.0", "20.0"]
    assert rows[3][4] == "-10.0"
    assert rows[4][2] == "not clean"
    assert rows[5][1] == "scattered_40, 2"
    assert rows[5][2].startswith("70.0 ± ")


def test_tables_of_a_file_are_not_searched_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    kept = tmp_path / "kept.jsonl"
    monkeypatch.setattr("sys.argv", ["bound.py", "--quick", "--keep", str(kept)])
    bound.main()
    first = capsys.readouterr().out
    told, there = map(json.loads, kept.read_text(encoding="utf-8").splitlines())
    assert told["bending"]["seconds"] <= told["free"]["seconds"] + 1
    assert there["left"] <= 2
    assert there["seconds"] == pytest.approx(told["bending"]["seconds"], rel=0.1)
    monkeypatch.setattr(bound, "layout_of", None)
    monkeypatch.setattr(bound, "carried_out_in_physics", None)
    bound.main()
    assert capsys.readouterr().out == first
