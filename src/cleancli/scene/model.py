"""The checked scene: a table, what lies on it, and who cleans it. Lengths in metres, angles in radians.

The origin is the middle of the surface; x points east, y north, z up from the surface.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import hypot, sqrt

from cleancli.scene.address import Address
from cleancli.scene.calibration import Calibration
from cleancli.scene.robots import ARMS

Colour = tuple[int, int, int]
"""Red, green and blue from 0 to 255."""

Axis = tuple[float, float, float]


@dataclass(frozen=True, slots=True)
class Surface:
    """A rectangular table top: extent along x and y, friction coefficient, colour.

    `tilt`: angles by which it rises towards east and towards north. z stays perpendicular to it. `texture`:
    standard deviation of its brightness, as a share of it; it changes over a length of about `grain`.
    """

    width: float
    depth: float
    friction: float
    colour: Colour
    tilt: tuple[float, float] = (0.0, 0.0)
    texture: float = 0.0
    grain: float = 0.01


@dataclass(frozen=True, slots=True)
class Container:
    """An open bin below one edge; `offset` shifts its middle along that edge (towards east or north)."""

    edge: str  # "north", "east", "south" or "west"
    offset: float
    width: float
    depth: float


@dataclass(frozen=True, slots=True)
class Zone:
    """A square of the surface into which dirt is pushed, and where it may lie: its middle, its side, and by
    how much it is turned, counter-clockwise."""

    centre: tuple[float, float]
    side: float
    turn: float


@dataclass(frozen=True, slots=True)
class Grasp:
    """How a rag is held. It hangs as a row of flaps on springs; this is what they differ in.

    `flap`: width of one. `gain`, `torque`: of a flap's spring, and the most it bears (N m). `angle_spread`,
    `gap_spread`: standard deviations of the angle at which a flap rests, and of its gap to the surface.
    `bow`: how far the row's ends lead its middle. `sweep`: angle by which both halves lie back.
    `skew`: angle by which the row is turned, counter-clockwise. `width`: of the rag, unless it is stated.
    """

    name: str
    flap: float
    gain: float
    torque: float
    angle_spread: float
    gap_spread: float
    bow: float
    sweep: float
    skew: float
    width: float


@dataclass(frozen=True, slots=True)
class Rag:
    """The cleaning cloth: how it is grasped, and how wide it is then."""

    grasp: Grasp
    width: float


@dataclass(frozen=True, slots=True)
class Light:
    """Where light comes from, as the angle from x and the angle above the surface.

    `ambient`: the share of it that a place gets which the lamp doesn't reach. `gradient`: how much more light
    than its middle the surface's corner towards the lamp gets, as a share; the far one gets as much less.
    """

    azimuth: float
    elevation: float
    ambient: float
    gradient: float = 0.0


LIGHT = Light(-0.8727, 1.2043, 0.62)
"""Chosen: from the south-east, 69 degrees up."""


@dataclass(frozen=True, slots=True)
class CameraSetup:
    """An RGB-D camera that looks at the middle of the surface, `height` above the place `at` of it.

    Image size and focal length in pixels. The picture's x points as far east as it can.
    """

    height: float
    image_width: int
    image_height: int
    focal: float
    at: tuple[float, float] = (0.0, 0.0)

    def axes(self) -> tuple[Axis, Axis, Axis]:
        """Where the picture's x and y and the optical axis point, as unit vectors of the scene."""
        x, y = self.at
        far = hypot(x, y, self.height)
        ahead = -x / far, -y / far, -self.height / far
        # East, without what of it points along the optical axis.
        side = sqrt(1 - ahead[0] ** 2)
        right = side, -ahead[0] * ahead[1] / side, -ahead[0] * ahead[2] / side
        down = (
            ahead[1] * right[2] - ahead[2] * right[1],
            ahead[2] * right[0] - ahead[0] * right[2],
            ahead[0] * right[1] - ahead[1] * right[0],
        )
        return right, down, ahead


@dataclass(frozen=True, slots=True)
class Group:
    """Particles dropped within `radius` of `centre`; `of` says what they are ("lentils"), `colour` which
    colour they have, if not one of their kind's."""

    count: int
    centre: tuple[float, float]
    radius: float
    of: str = "lentils"
    colour: Colour | None = None


@dataclass(frozen=True, slots=True)
class Scattered:
    """Particles spread evenly over the rectangle between two corners; `of` and `colour` as in `Group`."""

    count: int
    low: tuple[float, float]
    high: tuple[float, float]
    of: str = "lentils"
    colour: Colour | None = None


@dataclass(frozen=True, slots=True)
class Ink:
    """A line of ink drawn on the surface along points, `width` wide; blue, unless `colour` says otherwise."""

    along: tuple[tuple[float, float], ...]
    width: float
    colour: Colour | None = None


Dirt = Group | Scattered | Ink


@dataclass(frozen=True, slots=True)
class SymbolThresholds:
    """Where geometry becomes symbols (docs/perception.md): all lengths in metres, `density` a share.

    `link`: dirt closer than this belongs to one area. `small`, `medium`: longest diameter up to which an area
    is small, medium. `density`: an area whose ellipse is covered by dirt to a smaller share is scattered.
    `near`: gap between two ellipses up to which they are near. `traversal`: half width of the strip
    along a way of the rag in which an area counts as lying on it. `onward`: how far apart the middles of two
    areas may be over which one stroke goes. `most`: how many areas are planned for; of more, the `leave_out`
    ("smallest" or "farthest" from the container) are left for later (§4.2.1).
    """

    link: float
    small: float
    medium: float
    density: float
    near: float
    traversal: float
    onward: float = 0.45
    most: int = 1000
    leave_out: str = "smallest"


@dataclass(frozen=True, slots=True)
class Scene:
    """Everything a run needs to know before it starts; `robot` is the name of a drive ("gantry"), `domain`
    that of the domain whose actions clean it, `grasps` are those that the scene itself defines. Without a
    `calibration`, perception works with the default thresholds. `zone`: where dirt may lie, if anywhere.
    `height_noise`: standard deviation of the tool's height in strokes, None for the world's usual one.
    `address`: where the driver of a remote robot listens, None for a simulated one; `remote_arms`: how many
    arms a remote robot has."""

    name: str
    surface: Surface
    container: Container
    robot: str
    rag: Rag
    camera: CameraSetup
    dirt: tuple[Dirt, ...]
    symbols: SymbolThresholds
    seed: int
    domain: str = "cleaning"
    grasps: tuple[Grasp, ...] = ()
    light: Light = LIGHT
    calibration: Calibration | None = None
    zone: Zone | None = None
    height_noise: float | None = None
    address: Address | None = None
    remote_arms: int = 1

    @property
    def arms(self) -> int:
        """How many arms its robot has: with two it picks up (§3.2.2)."""
        return ARMS.get(self.robot, self.remote_arms)

    @property
    def driver(self) -> Address:
        """Where the driver of its remote robot listens."""
        assert self.address is not None, "a remote robot has an address"
        return self.address

    def outwards(self) -> tuple[float, float]:
        """The unit vector from the surface over the container's edge."""
        compass = {"north": (0.0, 1.0), "east": (1.0, 0.0), "south": (0.0, -1.0), "west": (-1.0, 0.0)}
        return compass[self.container.edge]

    def mouth(self) -> tuple[tuple[float, float], tuple[float, float]]:
        """The two ends of the stretch of table edge below which the container stands, as (x, y) points."""
        half, offset = self.container.width / 2, self.container.offset
        if self.container.edge in ("north", "south"):
            y = self.surface.depth / 2 * (1 if self.container.edge == "north" else -1)
            return (offset - half, y), (offset + half, y)
        x = self.surface.width / 2 * (1 if self.container.edge == "east" else -1)
        return (x, offset - half), (x, offset + half)
