"""A board of ink, wiped clean: the shipped domain, its job, what rivals do there, and what is told of it."""

from __future__ import annotations

from contextlib import closing
from pathlib import Path

import pytest

from cleancli.api.run_result import RunResult
from cleancli.compiler.task import GroundAction
from cleancli.execution.baselines import gather_all, nearest_first, wipe_all
from cleancli.execution.episode_state import Situation
from cleancli.execution.events import Ended
from cleancli.execution.loop import clean
from cleancli.execution.session import table_session
from cleancli.execution.setup import DecisionContext, EpisodeOptions, Job
from cleancli.execution.table_cell import TableCell
from cleancli.geometry.ellipse import Ellipse
from cleancli.language.diagnostics.diagnostic import Source
from cleancli.language.model import Problem
from cleancli.motion.actions import tool_path
from cleancli.motion.duration import expected_seconds
from cleancli.perception.area import Area
from cleancli.scene.check import load_scene
from cleancli.scene.model import Scene
from cleancli.world.table import PybulletTable
from support.shipped import shipped_domain

DOMAIN, OPTIONS = shipped_domain("wiping_ink"), EpisodeOptions()
BOARD = """scene board {
  surface { width = 50 cm  depth = 40 cm  colour = rgb(232, 234, 236) }
  camera  { image = 640 x 480  focal = 524 }
  dirt {
    ink { along = ((-15 cm, 5 cm), (-10 cm, 8 cm), (-5 cm, 5 cm), (0 cm, 8 cm)) }
    ink { along = ((0 cm, -10 cm), (6 cm, -10 cm)) }
  }
}
"""


@pytest.fixture(scope="module")
def scene() -> Scene:
    return load_scene(Source("board.nid", BOARD))


def now(scene: Scene, *places: tuple[float, float]) -> DecisionContext:
    """Areas a1, a2, ... at these places; the tool is above the first one."""
    areas = tuple(
        Area(Ellipse(place, (0.03, 0.01), 0.0), 1e-4, f"a{index}") for index, place in enumerate(places, 1)
    )
    problem = Problem("here", "wiping_ink", (), frozenset())
    situation = Situation(areas, (), frozenset())
    return DecisionContext(
        DOMAIN, problem, scene, Job.WIPE, situation, places[0], frozenset(), (), 0, 1, lambda actions: {}
    )


def test_a_board_ends_clean_with_few_actions_and_hardly_any_ink(scene: Scene) -> None:
    with closing(
        table_session(DOMAIN, scene, EpisodeOptions(samples=1000, seed=901, by_time=True))
    ) as session:
        *_, ended = clean(session.setup, session.cell)
        truth = session.truth()
    assert isinstance(ended, Ended)
    assert ended.clean
    assert ended.actions <= 3, "a stroke that comes down too high is repeated"
    assert isinstance(truth["ink_left"], float)
    assert truth["ink_left"] <= 0.02
    assert truth["particles"] == 0


def test_wiping_is_expected_to_begin_anywhere_and_not_at_the_container(scene: Scene) -> None:
    here = now(scene, (-0.1, 0.1)).situation
    with closing(PybulletTable(scene, 1)) as table:
        told = TableCell(DOMAIN, scene, table, 1).seconds(here, [GroundAction("wipe", ("a1",), 6.0)])
    path = tool_path("wipe", (here.areas[0].ellipse,), scene)
    assert told[("wipe", ("a1",))] == pytest.approx(expected_seconds(path, (0.0, 0.0)))


def test_rivals_wipe_as_well(scene: Scene) -> None:
    here = now(scene, (-0.1, 0.1), (0.15, -0.1), (-0.05, 0.12))
    assert nearest_first(here, OPTIONS).moves[0].key == ("wipe", ("a1",))
    (gathered,) = gather_all(here, OPTIONS).moves
    assert set(gathered.objects) == {"a1", "a2", "a3"}
    for move in (gathered, *wipe_all(here, OPTIONS).moves):
        assert move.path is not None
        places = [(w.x, w.y) for w in move.path.waypoints]
        assert all(abs(x) < 0.25 and abs(y) < 0.2 for x, y in places), "never into the container"


@pytest.mark.parametrize(
    ("truth", "told"),
    [
        ({"particles": 0, "ink_left": 0.0123}, ["truly: 1.2% of the ink left"]),
        ({"particles": 2, "ink_left": None}, ["truly: 2 of 2 particles in the container"]),
        ({"particles": 2, "ink_left": 0.5}, ["truly: 50.0% of the ink left", "truly: 2 of 2 particles"]),
    ],
)
def test_the_summary_tells_of_ink_where_there_was_ink(truth: dict[str, object], told: list[str]) -> None:
    more = {"in_container": 2, "on_table": 0, "on_floor": 0, "in_dustpan": 0, **truth}
    result = RunResult(Path("run"), True, "done", 1, {"actions": 1.0}, more, "", False, {})
    lines = [line for line in str(result).splitlines() if line.startswith("truly")]
    assert [line.startswith(begin) for line, begin in zip(lines, told, strict=True)] == [True] * len(told)
