"""What may be written in a scene, for completion and hover: sections, keys, and what their values look like;
the settings of a problem's planner, too.

The checkers (`scene.check`, `language.planner_options`) decide; the tests hold these tables against them and
against docs/language.md.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from cleancli.scene.check import DRIVES, EDGES, LEFT_OUT, SECTIONS
from cleancli.scene.check_dirt import PARTICLES
from cleancli.scene.grasps import SHIPPED


@dataclass(frozen=True, slots=True)
class KeyWords:
    """What a key means, and what a value of it begins with: units for a number, names, or an example."""

    meaning: str
    units: tuple[str, ...] = ()
    values: tuple[str, ...] = ()


LENGTHS = ("cm", "mm", "m")


ANGLES = ("deg", "rad")


def _angle(meaning: str) -> KeyWords:
    return KeyWords(meaning, ANGLES)


def _length(meaning: str) -> KeyWords:
    return KeyWords(meaning, LENGTHS)


_COLOUR = KeyWords("red, green and blue from 0 to 255", values=("rgb(205, 198, 184)",))

TOP = ""
"""The place outside of all sections."""

KEYS: Mapping[str, Mapping[str, KeyWords]] = {
    TOP: {
        "domain": KeyWords("the domain that says what cleaning actions do"),
        "seed": KeyWords("the seed of all randomness, a whole number"),
    },
    "surface": {
        "width": _length("the surface's extent along x"),
        "depth": _length("the surface's extent along y"),
        "friction": KeyWords("the friction coefficient, above 0 and at most 2"),
        "colour": _COLOUR,
        "tilt": KeyWords("how far it rises towards east and north", ANGLES, ("(0 deg, 0 deg)",)),
        "texture": KeyWords("how much its brightness varies, a share from 0 to 0.3 (standard deviation)"),
        "grain": _length("how far apart its lighter and darker places lie"),
    },
    "container": {
        "edge": KeyWords("the edge of the surface below which the container stands", values=EDGES),
        "offset": _length("how far its middle is shifted along the edge, towards east or north"),
        "width": _length("its extent along the edge"),
        "depth": _length("its extent away from the edge"),
    },
    "robot": {"drive": KeyWords("what moves the rag", values=DRIVES)},
    "grasp": {
        "flap": _length("the width of one of the flaps that the cloth hangs in"),
        "gain": KeyWords("the gain of a flap's spring, above 0 and at most 1"),
        "torque": KeyWords("the most that a flap's spring bears, N m"),
        "angle_spread": _angle("standard deviation of a flap's angle at rest"),
        "gap_spread": _length("standard deviation of a flap's gap to the surface"),
        "bow": _length("how far the rag's ends lead its middle"),
        "sweep": _angle("how far both halves of the rag lie back"),
        "skew": _angle("how far the rag is turned, counter-clockwise"),
        "width": _length("the rag's width in this grasp, where `rag` states none"),
    },
    "rag": {
        "grasp": KeyWords("how the rag is held", values=tuple(SHIPPED)),
        "width": _length("the rag's width"),
    },
    "camera": {
        "height": _length("the camera's height above the surface"),
        "image": KeyWords("the picture's size in pixels", values=("640 x 480",)),
        "focal": KeyWords("the focal length in pixels"),
        "at": KeyWords("above which place it hangs; it looks at the middle", LENGTHS, ("(0 cm, -50 cm)",)),
        "calibration": KeyWords("the file that `cleancli calibrate` wrote", values=('"table.json"',)),
    },
    "light": {
        "direction": KeyWords(
            "where light comes from: angle from x, angle above the surface", ANGLES, ("(-50 deg, 69 deg)",)
        ),
        "ambient": KeyWords("the share of light that comes from all around, above 0 and at most 1"),
        "gradient": KeyWords("how much more light falls on the side of the lamp, a share from 0 to 0.9"),
    },
    "dirt": {},
    "group": {
        "count": KeyWords("how many particles"),
        "of": KeyWords("what they are", values=PARTICLES),
        "at": KeyWords("the group's middle", LENGTHS, ("(0 cm, 0 cm)",)),
        "radius": _length("the circle that they lie in"),
        "colour": _COLOUR,
    },
    "scattered": {
        "count": KeyWords("how many particles"),
        "of": KeyWords("what they are", values=PARTICLES),
        "from": KeyWords("the rectangle's south-west corner", LENGTHS, ("(-10 cm, -10 cm)",)),
        "to": KeyWords("the rectangle's north-east corner", LENGTHS, ("(10 cm, 10 cm)",)),
        "colour": _COLOUR,
    },
    "ink": {
        "along": KeyWords("the points of the line", LENGTHS, ("((0 cm, 0 cm), (10 cm, 5 cm))",)),
        "width": _length("the line's width"),
        "colour": _COLOUR,
    },
    "symbols": {
        "link": _length("dirt closer than this is one area"),
        "small": _length("an area up to this long is small"),
        "medium": _length("an area up to this long is medium, a longer one big"),
        "density": KeyWords("an area with a smaller share of dirt is scattered, above 0 and at most 1"),
        "near": _length("areas closer than this are near each other"),
        "traversal": _length("an area closer than this to a straight way lies on it"),
        "most": KeyWords("how many areas are planned for, a whole number from 1 to 1000"),
        "leave_out": KeyWords("which areas are left for later if there are more", values=LEFT_OUT),
    },
}

INNER: Mapping[str, tuple[str, ...]] = {TOP: SECTIONS, "dirt": ("group", "scattered", "ink")}
"""The sections that a section may hold."""

PLANNER: Mapping[str, KeyWords] = {
    "name": KeyWords("the planner to use"),
    "samples": KeyWords("how many plans it tries, a whole number"),
    "seed": KeyWords("the seed of its randomness, a whole number"),
}
"""The settings of a problem's planner."""
