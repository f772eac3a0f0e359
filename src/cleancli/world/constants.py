"""Every physical number of the simulated table, in one place, each with its source or the word "chosen".

"Measured" means found by experiment with pybullet 3.2.7 before any strategies were compared (docs/world.md);
"chosen" means that the paper is silent and nobody measured it. Metres, seconds, kilograms, newtons, radians.
"""

from __future__ import annotations

import enum
from collections.abc import Mapping
from dataclasses import dataclass
from math import pi
from types import MappingProxyType

# Engine. Measured: at twice the step, or half the iterations, the outcomes of a push change.
STEP = 1 / 240
SOLVER_ITERATIONS = 30
CONTACT_BREAKING = 5e-4
GRAVITY = -9.81
STEPS_PER_PERIOD = 4  # chosen: the drive is commanded, and polled, 60 times a second


class Shape(enum.Enum):
    """What a particle is like, stretched to its size. A round one of one size is a ball, which rolls."""

    LENS = "lens"
    ROUND = "round"
    BOX = "box"


@dataclass(frozen=True, slots=True)
class Particle:
    """One kind of particle: full extents `size` (along, across, up), mass, friction and its rolling and
    spinning friction, colours that are drawn evenly, and its shape."""

    size: tuple[float, float, float]
    mass: float
    friction: float
    rolling: float
    colours: tuple[tuple[int, int, int], ...]
    shape: Shape = Shape.ROUND


# Lentils: size and contact measured. Rice: a long grain of about 6.5 x 2.2 mm, a thousand weigh 20-25 g.
# Peas: dried, 6-8 mm, a thousand weigh 200-250 g. Both are common figures; colours and friction are chosen,
# and so is the rolling friction of peas: one that is let go at 0.1 m/s rolls about 4 cm (tests/world).
# Blocks: size, mass, friction and colour as in the sweeping task of Zeng et al. (2020), Transporter Networks.
PARTICLES: Mapping[str, Particle] = MappingProxyType(
    {
        "lentils": Particle(
            (6e-3, 6e-3, 2.5e-3), 1e-4, 0.45, 3e-4, ((112, 74, 38), (92, 84, 34), (128, 92, 48)), Shape.LENS
        ),
        "rice": Particle((6.5e-3, 2.2e-3, 2.2e-3), 2.2e-5, 0.45, 2e-4, ((150, 120, 70), (140, 108, 62))),
        "peas": Particle((6.6e-3, 6.6e-3, 6.6e-3), 2.2e-4, 0.40, 8e-5, ((86, 120, 40), (104, 132, 52))),
        "blocks": Particle((1e-2, 1e-2, 1e-2), 1e-3, 0.50, 1e-4, ((255, 87, 89),), Shape.BOX),
    }
)
PARTICLE_MARGIN = 1e-4  # measured: with the engine's own 1 mm margin they float and drift
FRICTION_SPREAD = 0.20  # each particle's friction lies within this share of the mean; chosen
DROP_HEIGHT = 6e-3  # chosen
SETTLE_LIMIT = 4.0  # chosen: longest wait for dropped particles to come to rest
SETTLED_SPEED = 2e-3  # chosen

# Ink, chosen. A pass of the rag that presses hard enough takes INK_PASS of the ink, a lighter one less.
INK_CELL = 2e-3
INK_COLOUR = (44, 62, 128)  # unless the scene says otherwise
INK_PASS = 0.75
INK_BAND = 6e-3  # how far along its way a flap's lower edge touches the surface
INK_FORCE = 0.02  # newtons on a flap from which on it takes no more
INK_HEIGHT = 3e-4  # what the renderer shows within this of z = 0 is the surface
INK_SEEN = 0.15  # amount of ink in a cell below which perception can't tell it from the surface

# A zone in pictures for people, chosen: its colour, and how much of it is laid over the surface's.
ZONE_COLOUR = (60, 170, 90)
ZONE_PAINT = 0.5

# The surface's texture, chosen.
TEXTURE_CELL = 1e-3
TEXTURE_SEED = 1

# Furniture, chosen. The container reaches under the table: measured, a gap of 5 mm loses lentils.
TABLE_HEIGHT = 0.70
TABLE_THICKNESS = 0.02
LEG = 0.04
FLOOR_HALF = 1.2
FLOOR_THICKNESS = 0.2
FLOOR_COLOUR = (238, 238, 236)
LEG_COLOUR = (120, 100, 82)
CONTAINER_HEIGHT = 0.09
CONTAINER_WALL = 0.006
CONTAINER_BOTTOM = 0.03  # a lentil falls 6 mm a step: measured, it passes through a bottom of 6 mm
CONTAINER_OVERLAP = 0.03
CONTAINER_DROP = 1e-3  # the rim's gap to the table's underside; a lentil is thicker
CONTAINER_COLOUR = (62, 96, 150)
CONTAINER_FRICTION = 0.8

# Tool noise, drawn once per stroke. Measured together with the rag (outcome shares in docs/world.md).
HEIGHT_NOISE = 1.75e-3
SIDE_NOISE = 4e-3
YAW_NOISE = 0.05

# How far below the surface a stroke puts the rag's edge on average: who wipes presses the cloth down, and it
# gives way (§7). Chosen, about the error of its height: unpressed, one stroke in eight passes over all dirt.
# Not where a dustpan takes part, which the rag would push away.
PRESS = 2e-3

# The rag: a row of spring-hinged flaps. Measured: soft bodies eject lentils, or move none.
FLAP_HEIGHT = 0.036
FLAP_THICKNESS = 4e-3
FLAP_MASS = 4e-3
FLAP_FRICTION = 0.35
# A cloth has no rigid edge: what presses it compresses it. A flap that could not give way would be a strut
# wherever it leans less than friction lets it slide, and bear more than an arm can press (measured: 330 N).
# Chosen, for each metre of a flap's width: N/m and N s/m; a pressed rag then bears 1 to 2 N a flap.
CLOTH_STIFFNESS = 1e5
CLOTH_DAMPING = 150.0
# Chosen: a dragged cloth leans back. Flaps leaning both ways leave holes between them that no cloth has.
FLAP_LEAN = 0.2
RAG_COLOUR = (196, 60, 52)
HOLDER_COLOUR = (70, 72, 78)
HOLDER_SIZE = (0.03, 0.03)  # along the push direction, and up
POST_RADIUS = 0.015
POST_HEIGHT = 0.40


# Camera. Depth noise and quantisation as Khoshelham and Oude Elberink (Sensors, 2012) measured of the Kinect:
# both grow with the square of the distance; the rest is chosen.
NEAR, FAR = 0.08, 3.0
DEPTH_NOISE = 1.2e-3 / 0.9**2  # standard deviation is this times z²
DEPTH_STEP = 2.85e-3  # step between neighbouring depth values is this times z²
EDGE_JITTER = 1  # pixels
EDGE_JUMP = 0.02  # where jitter moves depth by more than this,
EDGE_DROPOUT = 0.5  # this share of pixels has no depth
COLOUR_SHIFT = 1  # pixels, to the right of depth
COLOUR_NOISE = 3.0

# The onlooker's camera, chosen.
PICTURE_FIELD = 0.14 * pi  # vertical opening angle
PICTURE_FILLED = 0.94  # share of it that the table and the robot fill at most
PICTURE_ELEVATION = 0.27 * pi  # how far above the table's level it stands, seen from there
PICTURE_RANGE = (1.0, 4.0)  # what is so far before and behind the table and the robot is seen too
WALL_COLOUR = (221, 227, 233)  # where there is nothing else
SHADOW_CELL = 3e-3  # side of a pixel in the light's picture
SHADOW_BIAS = 2e-3  # what lies at most so far before a place throws no shadow on it
LAMP_FIELD = 0.03  # opening angle of the light's picture: the smaller, the farther away the light
LAMP_RANGE = (1.0, 1.0)  # as PICTURE_RANGE, of the light
LEVEL = 4e-4  # heights of neighbouring pixels of a level surface differ by less
