"""The table as characters, whole: a surface of 80 x 64 cm in 20 columns, so that a column is 4 cm wide."""

from __future__ import annotations

import pytest

from cleancli.cli.views.table_map import rows_for, table_map
from cleancli.execution.episode_state import Situation
from cleancli.geometry.ellipse import Ellipse
from cleancli.language.diagnostics.diagnostic import Source
from cleancli.motion.path import Interpolation, ToolPath, Waypoint
from cleancli.perception.area import Area
from cleancli.scene.check import load_scene
from cleancli.scene.model import Scene

FIRST = Area(Ellipse((-0.2, 0.15), (0.12, 0.06), 0.0), 1e-3, "a1")
SLANTED = Area(Ellipse((0.15, -0.2), (0.15, 0.05), 0.785), 1e-3, "a2")
BELIEVED = Situation((FIRST, SLANTED), (), frozenset(), unseen=frozenset({"a2"}))
CORNERS = ((-0.35, -0.2, 0.05), (-0.35, -0.2, 0.0), (0.35, 0.0, 0.0), (0.5, 0.0, 0.0), (0.5, 0.0, 0.05))
PUSH = ToolPath(tuple(Waypoint(*corner, 0.0, 0.1) for corner in CORNERS), Interpolation.STRAIGHT)


def scene(edge: str) -> Scene:
    text = (
        "scene s { surface { width = 80 cm  depth = 64 cm }"
        f" container {{ edge = {edge}  offset = 8 cm  width = 32 cm }}"
        " dirt { group { count = 3  at = (0 cm, 0 cm)  radius = 2 cm } } }"
    )
    return load_scene(Source("s.nid", text))


def test_areas_the_way_the_tool_and_the_mouth_in_the_east() -> None:
    assert table_map(scene("east"), BELIEVED, PUSH, (-0.35, -0.2), 20, ascii_only=True).plain == "\n".join(
        [
            "+--------------------+",
            "|                    |",
            "|   ****             #",
            "|  ***a1*            #",
            "|                    #",
            "|           .........#",
            "|     .......  ???   #",
            "| @...       ?a2     |",
            "|           ??       |",
            "+--------------------+",
        ]
    )


def test_in_boxes_with_the_mouth_in_the_north_and_the_tool_beside_the_surface() -> None:
    assert table_map(scene("north"), BELIEVED, None, (0.41, 0), 20).plain == "\n".join(
        [
            "┌────────━━━━━━━━━───┐",
            "│                    │",
            "│   ▒▒▒▒             │",
            "│  ▒▒▒a1▒            │",
            "│                    │",
            "│                    │",
            "│              ░░░   │",
            "│            ░a2     │",
            "│           ░░       │",
            "└────────────────────┘",
        ]
    )


@pytest.mark.parametrize(("edge", "line", "at"), [("west", 2, 0), ("south", -1, 9)])
def test_the_mouth_at_the_other_edges(edge: str, line: int, at: int) -> None:
    lines = table_map(scene(edge), None, None, None, 20, ascii_only=True).plain.split("\n")
    assert lines[line][at] == {"west": "#", "south": "="}[edge]
    mouth = {"west": "#", "south": "="}[edge]
    assert "".join(lines).count(mouth) == {"west": 5, "south": 9}[edge]
    assert not set("".join(lines)) - set(f"+-| {mouth}")


@pytest.mark.parametrize(("columns", "rows"), [(20, 8), (40, 16), (5, 3), (36, 14)])
def test_lengths_look_right_where_characters_are_twice_as_high_as_wide(columns: int, rows: int) -> None:
    assert rows_for(scene("east"), columns) == rows
    lines = table_map(scene("east"), BELIEVED, PUSH, None, columns).plain.split("\n")
    assert len(lines) == rows + 2
    assert {len(line) for line in lines} == {columns + 2}


def test_places_on_the_very_edge_are_on_the_surface() -> None:
    for x, y in ((0.4, 0.32), (-0.4, -0.32), (0.4, -0.32), (-0.4, 0.32)):
        assert "@" in table_map(scene("east"), None, None, (x, y), 20, ascii_only=True).plain
    for x, y in ((0.401, 0.0), (0.0, 0.321), (-0.401, 0.0), (0.0, -0.321)):
        assert "@" not in table_map(scene("east"), None, None, (x, y), 20, ascii_only=True).plain
