"""Scenes against docs/language.md: what is left out is as its tables say, a setting sets its own part."""

from __future__ import annotations

import re
from dataclasses import astuple, replace
from math import radians
from pathlib import Path

import pytest

from cleancli.language.diagnostics.diagnostic import Source
from cleancli.language.diagnostics.refused import Refused
from cleancli.scene.check import load_scene
from cleancli.scene.format import print_scene
from cleancli.scene.grasps import SHIPPED
from cleancli.scene.model import Scene
from cleancli.scene.robots import ARMS

ROOT = Path(__file__).parent.parent.parent
LANGUAGE = (ROOT / "docs" / "language.md").read_text(encoding="utf-8")
DIRT = "dirt { group { count = 3  at = (0 cm, 0 cm)  radius = 2 cm } }"


def scene(inside: str = "") -> Scene:
    return load_scene(Source("s.nid", f"scene s {{ {inside} {DIRT} }}"))


def accepted(inside: str) -> bool:
    try:
        scene(inside)
    except Refused:
        return False
    return True


def documented() -> dict[str, list[str]]:
    """Section -> its settings with their defaults, as the table writes them."""
    rows = re.findall(r"^\| (`\w+`|\(top\)) \| (.*) \|$", LANGUAGE.split("## Scenes")[1], re.M)
    found = {}
    for name, told in rows[:10]:
        settings = re.findall(r"`(\w+ = [^`]+)`", told)
        found[name.strip("`")] = [setting for setting in settings if "calibration" not in setting]
    return found


def test_the_table_is_read() -> None:
    found = documented()
    assert list(found) == [
        "(top)", "surface", "container", "zone", "robot", "rag", "camera", "light", "dirt", "symbols",
    ]  # fmt: skip
    assert sum(map(len, found.values())) == 34


@pytest.mark.parametrize("section", [name for name in documented() if name not in ("dirt", "zone")])
def test_what_is_left_out_is_as_documented(section: str) -> None:
    settings = "  ".join(documented()[section])
    told, bare = scene(settings if section == "(top)" else f"{section} {{ {settings} }}"), scene()
    assert replace(told, light=bare.light) == bare
    assert astuple(told.light) == pytest.approx(astuple(bare.light), abs=radians(0.01))


def shipped_grasps() -> dict[str, dict[str, str]]:
    table = LANGUAGE.split("| grasp | flap |")[1]
    names = ["flap", *re.findall(r"\w+", table.splitlines()[0])]
    rows = re.findall(r"^\| `(\w+)` \| (.*) \|$", table, re.M)
    return {name: dict(zip(names, values.split(" | "), strict=True)) for name, values in rows}


@pytest.mark.parametrize("name", SHIPPED)
def test_shipped_grasps_are_as_documented(name: str) -> None:
    settings = "  ".join(f"{key} = {value}" for key, value in shipped_grasps()[name].items())
    (own,) = scene(f"grasp mine {{ {settings} }}").grasps
    told, shipped = replace(own, name=name), SHIPPED[name]
    for field in shipped_grasps()[name]:
        assert getattr(told, field) == pytest.approx(getattr(shipped, field)), field


def test_each_setting_of_a_grasp_sets_its_own_part() -> None:
    inside = (
        "grasp mine { flap = 3 cm  gain = 0.2  torque = 0.05  angle_spread = 4 deg  gap_spread = 0.7 mm"
        "  bow = 8 mm  sweep = 9 deg  skew = -7 deg  width = 15 cm } rag { grasp = mine }"
    )
    grasp = scene(inside).rag.grasp
    values = [getattr(grasp, name) for name in shipped_grasps()["wide"]]
    wanted = [0.03, 0.2, 0.05, radians(4), 0.7e-3, 8e-3, radians(9), radians(-7), 0.15]
    assert values == pytest.approx(wanted)
    assert scene(inside).rag.width == pytest.approx(0.15)
    assert scene(inside.replace("grasp = mine", "grasp = mine width = 9 cm")).rag.width == pytest.approx(0.09)
    (left_out,) = scene("grasp bare { gain = 0.2 }").grasps
    assert replace(left_out, name="wide", gain=SHIPPED["wide"].gain) == SHIPPED["wide"]


@pytest.mark.parametrize(
    ("setting", "most", "more"),
    [
        ("surface {{ tilt = ({}, 0 deg) }}", "10 deg", "10.1 deg"),
        ("surface {{ tilt = (0 deg, {}) }}", "-10 deg", "-10.1 deg"),
        ("surface {{ texture = {} }}", "0.3", "0.301"),
        ("light {{ gradient = {} }}", "0.9", "0.901"),
        ("rag {{ width = {} }} container {{ width = 20 cm }}", "20 cm", "20.1 cm"),
        ("container {{ width = 32 cm  offset = {} }}", "19 cm", "19.1 cm"),
        ("container {{ width = 32 cm  offset = {} }}", "-19 cm", "-19.1 cm"),
        ("container {{ edge = north  width = 32 cm  offset = {} }}", "29 cm", "29.1 cm"),
        ("grasp fine {{ flap = 2 mm }} rag {{ grasp = fine  width = {} }}", "12 cm", "12.2 cm"),
        ("symbols {{ small = {}  medium = 12 cm }}", "11.9 cm", "12 cm"),
        ("symbols {{ most = {} }}", "1000", "1001"),
    ],
)
def test_what_is_at_a_limit_fits_and_what_is_beyond_is_refused(setting: str, most: str, more: str) -> None:
    assert accepted(setting.format(most))
    assert not accepted(setting.format(more))


@pytest.mark.parametrize(
    ("at", "corner"),
    [
        ("(30 cm, 0 cm)", "south-east"),
        ("(-30 cm, 0 cm)", "south-west"),
        ("(0 cm, 30 cm)", "north-west"),
        ("(0 cm, -30 cm)", "south-west"),
    ],
)
def test_a_corner_that_the_camera_does_not_see_is_named(at: str, corner: str) -> None:
    """It looks at the middle from aside, so that the corners nearest to it leave the picture first."""
    with pytest.raises(Refused) as refused:
        scene(f"camera {{ height = 75 cm  at = {at} }}")
    (found,) = refused.value.diagnostics
    assert (found.code, found.label) == ("E510", f"the {corner} corner is outside the picture")


@pytest.mark.parametrize("drive", ARMS)
@pytest.mark.parametrize("edge", ["north", "east", "south", "west"])
def test_words_are_taken_as_they_are(drive: str, edge: str) -> None:
    found = scene(
        f"robot {{ drive = {drive} }} container {{ edge = {edge} }} symbols {{ leave_out = farthest }}"
    )
    assert (found.robot, found.container.edge) == (drive, edge)
    assert found.symbols.leave_out == "farthest"
    assert not accepted("robot { drive = crane }")
    assert not accepted("container { edge = up }")


def test_the_pages_tell_of_every_robot() -> None:
    (row,) = re.findall(r"^\| `robot` \|(.*)\|$", LANGUAGE, re.M)
    world = (ROOT / "docs" / "world.md").read_text(encoding="utf-8")
    for robot in ARMS:
        assert re.search(rf"\b{robot}\b", row)
        assert f"\n### `{robot}`\n" in world


def test_a_robot_elsewhere_has_an_address_and_needs_no_dirt() -> None:
    found = scene('robot { drive = remote  address = "localhost:7420" }')
    assert str(found.address) == "127.0.0.1:7420"
    bare = load_scene(Source("s.nid", 'scene s { robot { drive = remote  address = "127.0.0.1:1" } }'))
    assert bare.dirt == ()
    assert load_scene(Source("s.nid", print_scene(bare))) == bare
    assert load_scene(Source("s.nid", print_scene(found))) == found
    assert bare.arms == 1
    both = replace(bare, remote_arms=2)
    assert load_scene(Source("s.nid", print_scene(both))) == both
    assert both.arms == 2
    assert replace(both, robot="gantry").arms == 1, "a simulated robot has its own"
