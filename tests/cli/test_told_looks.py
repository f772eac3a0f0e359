"""What `cleancli perceive` prints of looks, word for word."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from cleancli.api.observations import TOLD
from cleancli.api.observations import described as _described
from cleancli.api.observations import told as _printed
from cleancli.geometry.ellipse import Ellipse
from cleancli.language.model import Fact
from cleancli.perception.area import Area
from cleancli.perception.occlusion import Known, Unseen
from cleancli.perception.tracking import Merge, Split

FIRST = Area(Ellipse((-0.2, 0.05), (0.03, 0.0225), 0.5), 1.25e-3, "a1")
SECOND = Area(Ellipse((0.1234, 0.0), (0.05, 0.01), 0.0), 2e-4, "a2")


def look(*facts: Fact, share: float = 0.0, hidden: tuple[float, float] = (0.0, 0.0), **more: Any) -> Any:
    cells = np.zeros((100, 10), np.bool_)
    cells.flat[: round(share * cells.size)] = True
    known = Known(
        (FIRST, SECOND),
        dict(zip(("a1", "a2"), hidden, strict=True)),
        Unseen(cells, (-0.4, -0.3), (0.4, 0.3)),
        more.get("changes", ()),
        3,
    )
    found = SimpleNamespace(
        areas=more.get("areas", known.areas),
        state=frozenset(facts),
        known=known,
        left_out=more.get("left_out", ()),
        frames=(SimpleNamespace(clock=1.5), SimpleNamespace(clock=1.75)),
        observation=SimpleNamespace(doubts=("the surface is darker",), arrived=more.get("arrived")),
    )
    return SimpleNamespace(source=more.get("source", "table"), look=found)


def test_a_look_at_two_areas() -> None:
    facts = (
        Fact("dirt", ("a1",)),
        Fact("dirt", ("a2",)),
        Fact("scattered", ("a2",)),
        Fact("size", ("a1",), "small"),
        Fact("size", ("a2",), "medium"),
        Fact("near", ("a1", "a2")),
    )
    assert list(_printed(look(*facts))) == [
        "table: 2 areas",
        "  a1: at (-20, 5) cm, 6 x 4.5 cm, small",
        "  a2: at (12.3, 0) cm, 10 x 2 cm, medium, scattered",
        "  near: (a1 a2)",
    ]


@pytest.mark.parametrize(
    ("share", "told"),
    [(0.004, ""), (0.005, ", 0% of the surface unseen"), (0.25, ", 25% of the surface unseen")],
)
def test_what_is_unseen_is_told_from_half_a_percent(share: float, told: str) -> None:
    assert next(_printed(look(share=share))) == f"table: 2 areas{told}"


def test_what_is_hidden_is_told() -> None:
    lines = list(_printed(look(hidden=(1.0, 0.4))))
    assert lines[1].endswith("4.5 cm, remembered")
    assert lines[2].endswith("2 cm, 40% hidden")


def test_changes_and_what_is_left_out_are_told() -> None:
    changes = (Split("a1", ("a1", "a2")), Merge(("a1", "a3"), "a1"))
    second = look(source="next", changes=changes, left_out=("a2",), areas=(FIRST,))
    assert list(_printed(second)) == [
        "next: 1 area",
        "  a1 split into a1, a2",
        "  a3 merged into a1",
        "  a1: at (-20, 5) cm, 6 x 4.5 cm",
        "  left out of plans: a2",
    ]


@pytest.mark.parametrize("number", [1, TOLD, TOLD + 1])
def test_many_facts_are_counted(number: int) -> None:
    facts = [Fact("traversal", ("a1", f"b{place:02}", "a2")) for place in range(number)]
    last = list(_printed(look(*facts)))[-1]
    if number > TOLD:
        assert last == f"  traversal: {number} times; --json tells where"
    else:
        assert last == "  traversal: " + ", ".join(f"(a1 b{place:02} a2)" for place in range(number))


def test_json_has_lengths_in_metres() -> None:
    facts = (Fact("dirt", ("a1",)), Fact("size", ("a1",), "small"), Fact("near", ("a1", "a2")))
    told: Any = _described(look(*facts, share=0.25, hidden=(0.1234, 0.0), left_out=("a2",)))
    assert told["areas"][0] == {
        "area": "a1", "at": [-0.2, 0.05], "diameters": [0.06, 0.045], "angle": 0.5, "covered": 0.00125,
        "hidden": 0.123, "size": "small",
    }  # fmt: skip
    assert (told["source"], told["clock"]) == ("table", 1.75)
    assert told["facts"] == {"near": [["a1", "a2"]]}
    assert (told["left_out"], told["doubts"], told["changes"]) == (("a2",), ["the surface is darker"], [])
    assert told["unseen"]["share"] == 0.25
    (outline,) = told["unseen"]["outlines"]
    assert np.min(outline, axis=0) == pytest.approx((-0.4, -0.3), abs=0.05)
    assert np.max(outline, axis=0)[1] == pytest.approx(-0.15, abs=0.05)


def test_what_lies_in_the_zone_is_told_of_scenes_that_have_one() -> None:
    seen = look(Fact("dirt", ("a1",)), arrived=0.62345)
    assert "  in the zone: 62% of the dirt that is seen" in list(_printed(seen))
    assert _described(seen)["in_zone"] == 0.6234
    elsewhere = look(Fact("dirt", ("a1",)))
    assert not any("zone" in line for line in _printed(elsewhere))
    assert _described(elsewhere)["in_zone"] is None
