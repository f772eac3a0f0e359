"""Every setting of a scene: its section and key, the kind of its value, its default and what it means.

The checker reads by this table, the printer writes by it, editors complete and explain by it, and the tests
hold docs/language.md against it. The defaults are choices, nobody's measurement: those of
problems/two_groups.nid.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any, Final

from cleancli.scene.grasps import SHIPPED, WIDE
from cleancli.scene.kinds import (
    Angle,
    Angles,
    Choice,
    Colour,
    File,
    HostPort,
    Image,
    Kind,
    Length,
    Line,
    Number,
    Point,
    Whole,
)
from cleancli.scene.model import LIGHT
from cleancli.scene.robots import DRIVES

EDGES = ("north", "east", "south", "west")
LEFT_OUT = ("smallest", "farthest")
PARTICLES = ("lentils", "rice", "peas", "blocks")
MOST_PARTICLES = 500
"""Of one group: far more than any table of the paper has (40), few enough to simulate."""
MOST_POINTS = 200
"""Of one line of ink."""

NEEDED: Final = object()
"""The default of a setting that must be given."""

TOP = ""
"""The place outside of all sections."""


@dataclass(frozen=True, slots=True)
class Key:
    """A setting. Its `default` is NEEDED where it has none, and None where nothing stands for being left out.
    `example`: what editors offer to write."""

    kind: Kind
    default: Any
    meaning: str
    example: str = ""

    @property
    def units(self) -> tuple[str, ...]:
        """What its numbers may be followed by."""
        return self.kind.units

    @property
    def values(self) -> tuple[str, ...]:
        """What a value of it may be, or looks like."""
        if self.example:
            return (self.example,)
        return self.kind.choices or () if isinstance(self.kind, Choice) else ()


_RGB = "rgb(205, 198, 184)"
_COUNT = Key(Whole(1, MOST_PARTICLES), NEEDED, "how many particles")
_OF = Key(Choice(PARTICLES, "kind of particle"), "lentils", "what they are")
_COLOUR = "red, green and blue from 0 to 255"
_OWN_COLOUR = Key(Colour(), None, _COLOUR, _RGB)
_UP_TO_5_M = Length(0.001, 5.0)

KEYS: Mapping[str, Mapping[str, Key]] = MappingProxyType(
    {
        TOP: {
            "domain": Key(Choice(), "cleaning", "the domain that says what cleaning actions do"),
            "seed": Key(Whole(0, 2**31 - 1), 1, "the seed of all randomness, a whole number"),
        },
        "surface": {
            "width": Key(Length(0.1, 5.0), 0.90, "the surface's extent along x"),
            "depth": Key(Length(0.1, 5.0), 0.70, "the surface's extent along y"),
            "friction": Key(Number(0, 2), 0.45, "the friction coefficient, above 0 and at most 2"),
            "colour": Key(Colour(), (205, 198, 184), _COLOUR, _RGB),
            "tilt": Key(
                Angles(Angle(-10, 10), Angle(-10, 10)),
                (0.0, 0.0),
                "how far it rises towards east and north",
                "(0 deg, 0 deg)",
            ),
            "texture": Key(
                Number(0, 0.3, including=True),
                0.0,
                "how much its brightness varies, a share from 0 to 0.3 (standard deviation)",
            ),
            "grain": Key(Length(0.001, 0.5), 0.01, "how far apart its lighter and darker places lie"),
        },
        "container": {
            "edge": Key(Choice(EDGES), "east", "the edge of the surface below which the container stands"),
            "offset": Key(
                Length(negative=True),
                0.0,
                "how far its middle is shifted along the edge, towards east or north",
            ),
            "width": Key(Length(0.01, 5.0), 0.32, "its extent along the edge"),
            "depth": Key(Length(0.01, 5.0), 0.16, "its extent away from the edge"),
        },
        "zone": {
            "at": Key(Point(), NEEDED, "the middle of the square that dirt is pushed into", "(0 cm, 0 cm)"),
            "side": Key(Length(0.02, 5.0), 0.12, "the square's side"),
            "turn": Key(Angle(-360, 360), 0.0, "how far it is turned, counter-clockwise"),
        },
        "robot": {
            "drive": Key(Choice(DRIVES), "gantry", "what moves the rag"),
            "address": Key(
                HostPort(), None, "where the driver of a remote robot listens", '"127.0.0.1:7420"'
            ),
            "arms": Key(
                Whole(1, 2), None, "how many arms a remote robot has, if not one: the second holds a dustpan"
            ),
            "height_noise": Key(
                Length(most=0.05, zero=True),
                None,
                "standard deviation of how high the tool comes down in a stroke, if not the usual one",
            ),
        },
        "grasp": {
            "flap": Key(
                Length(0.001, 1.0), WIDE.flap, "the width of one of the flaps that the cloth hangs in"
            ),
            "gain": Key(Number(0, 1), WIDE.gain, "the gain of a flap's spring, above 0 and at most 1"),
            "torque": Key(Number(0, 10), WIDE.torque, "the most that a flap's spring bears, N m"),
            "angle_spread": Key(
                Angle(0, 30), WIDE.angle_spread, "standard deviation of a flap's angle at rest"
            ),
            "gap_spread": Key(
                Length(most=0.01, zero=True),
                WIDE.gap_spread,
                "standard deviation of a flap's gap to the surface",
            ),
            "bow": Key(Length(most=0.1, zero=True), WIDE.bow, "how far the rag's ends lead its middle"),
            "sweep": Key(Angle(0, 45), WIDE.sweep, "how far both halves of the rag lie back"),
            "skew": Key(Angle(-45, 45), WIDE.skew, "how far the rag is turned, counter-clockwise"),
            "width": Key(_UP_TO_5_M, WIDE.width, "the rag's width in this grasp, where `rag` states none"),
        },
        "rag": {
            "grasp": Key(Choice(tuple(SHIPPED)), "wide", "how the rag is held"),
            "width": Key(_UP_TO_5_M, None, "the rag's width"),
        },
        "camera": {
            "height": Key(Length(0.1), 0.9, "the camera's height above the surface"),
            "image": Key(Image(), (640, 480), "the picture's size in pixels", "640 x 480"),
            "focal": Key(Number(10, 100_000, including=True), 525.0, "the focal length in pixels"),
            "at": Key(
                Point(),
                (0.0, 0.0),
                "above which place it hangs; it looks at the middle",
                "(0 cm, -50 cm)",
            ),
            "calibration": Key(File(), None, "the file that `cleancli calibrate` wrote", '"table.json"'),
        },
        "light": {
            "direction": Key(
                Angles(Angle(-360, 360), Angle(5, 90)),
                (LIGHT.azimuth, LIGHT.elevation),
                "where light comes from: angle from x, angle above the surface",
                "(-50 deg, 69 deg)",
            ),
            "ambient": Key(
                Number(0, 1),
                LIGHT.ambient,
                "the share of light that comes from all around, above 0 and at most 1",
            ),
            "gradient": Key(
                Number(0, 0.9, including=True),
                LIGHT.gradient,
                "how much more light falls on the side of the lamp, a share from 0 to 0.9",
            ),
        },
        "dirt": {},
        "symbols": {
            "link": Key(Length(0.001, 1.0), 0.05, "dirt closer than this is one area"),
            "small": Key(Length(0.001), 0.06, "an area up to this long is small"),
            "medium": Key(Length(0.001), 0.12, "an area up to this long is medium, a longer one big"),
            "density": Key(
                Number(0, 1),
                0.14,
                "an area with a smaller share of dirt is scattered, above 0 and at most 1",
            ),
            "near": Key(Length(zero=True), 0.20, "areas closer than this are near each other"),
            "traversal": Key(Length(0.001), None, "an area closer than this to a way of the rag lies on it"),
            "onward": Key(Length(0.001), 0.45, "a sweep goes on to an area closer than this"),
            "most": Key(
                Whole(1, 1000), 1000, "how many areas are planned for, a whole number from 1 to 1000"
            ),
            "leave_out": Key(
                Choice(LEFT_OUT), "smallest", "which areas are left for later if there are more"
            ),
        },
        "group": {
            "count": _COUNT,
            "of": _OF,
            "at": Key(Point(), NEEDED, "the group's middle", "(0 cm, 0 cm)"),
            "radius": Key(Length(), NEEDED, "the circle that they lie in"),
            "colour": _OWN_COLOUR,
        },
        "scattered": {
            "count": _COUNT,
            "of": _OF,
            "from": Key(Point(), NEEDED, "the rectangle's south-west corner", "(-10 cm, -10 cm)"),
            "to": Key(Point(), NEEDED, "the rectangle's north-east corner", "(10 cm, 10 cm)"),
            "colour": _OWN_COLOUR,
        },
        "ink": {
            "along": Key(
                Line(MOST_POINTS), NEEDED, "the points of the line", "((0 cm, 0 cm), (10 cm, 5 cm))"
            ),
            "width": Key(Length(0.001, 1.0), 0.008, "the line's width"),
            "colour": _OWN_COLOUR,
        },
    }
)

DIRT = ("group", "scattered", "ink")
"""The kinds of dirt, which are sections of `dirt`."""

SECTIONS = tuple(name for name in KEYS if name not in (TOP, *DIRT))

INNER: Mapping[str, tuple[str, ...]] = {TOP: SECTIONS, "dirt": DIRT}
"""The sections that a section may hold."""
