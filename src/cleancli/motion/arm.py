"""A seven-joint arm as data: forward kinematics, and closed-form inverse kinematics.

The arm has the build of a human's: the axes of its first three joints meet in a shoulder, those of its last
three in a wrist, and joint 4 is the elbow. So inverse kinematics has a closed form: for one pose of the tool
the elbow may still swivel about the line from shoulder to wrist, and for each swivel there are eight
solutions, one a branch. They are exact and complete, and cost one pass of numpy for thousands of poses.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product

import numpy as np

from cleancli.array_types import Floats

Joints = tuple[float, float, float, float, float, float, float]

TWISTS = (-np.pi / 2, np.pi / 2, -np.pi / 2, np.pi / 2, -np.pi / 2, np.pi / 2, 0.0)
BRANCHES = np.array(tuple(product((1.0, -1.0), repeat=3)))  # of elbow, shoulder and wrist, (8, 3)
SWIVELS = np.linspace(-np.pi, np.pi, 48, endpoint=False)


@dataclass(frozen=True, slots=True)
class Capsule:
    """The hull of a link: a thick line between two points in the frame after row `frame`, 0 for the base;
    metres."""

    frame: int
    begin: tuple[float, float, float]
    end: tuple[float, float, float]
    radius: float


@dataclass(frozen=True, slots=True)
class Arm:
    """Lengths a and d of the distal Denavit-Hartenberg rows (m; the twists are `TWISTS`), joint limits (rad,
    rad/s, rad/s²), the pose of the base (4, 4), and how far the tool's point lies before the last joint's
    flange.

    `posture` is where the joints would rather be. The tool's frame has z up, against the last joint's axis,
    and x along the push. `hulls` are checked against each other for the pairs `apart`.
    """

    offsets: Joints
    lengths: Joints
    low: Joints
    high: Joints
    speed: Joints
    acceleration: Joints
    posture: Joints
    base: tuple[tuple[float, ...], ...]
    tool: float
    hulls: tuple[Capsule, ...]
    apart: tuple[tuple[int, int], ...]

    def __post_init__(self) -> None:
        """Shoulder and wrist must be points: only rows 3 and 4 have offsets, only 3, 5 and 7 lengths."""
        assert not any((*self.offsets[:2], *self.offsets[4:])), "the shoulder and the wrist are no points"
        assert not any(self.lengths[k] for k in (0, 1, 3, 5)), "the shoulder and the wrist are no points"


def poses(points: Floats, tilts: Floats) -> Floats:
    """(n, 4, 4) tool frames of (x, y, z, yaw) in `points` (n, 4), leaning ahead by `tilts` (n,).

    The tool tilts about the line along the rag: that line stays on the surface.
    """
    cos, sin, zero = np.cos(points[:, 3]), np.sin(points[:, 3]), np.zeros(len(points))
    lean, rise = np.cos(tilts), np.sin(tilts)
    frames = np.zeros((len(points), 4, 4))
    frames[:, :3, 0] = np.stack((cos * lean, sin * lean, -rise), axis=1)
    frames[:, :3, 1] = np.stack((-sin, cos, zero), axis=1)
    frames[:, :3, 2] = np.stack((cos * rise, sin * rise, lean), axis=1)
    frames[:, :3, 3] = points[:, :3]
    frames[:, 3, 3] = 1
    return frames


def frames(arm: Arm, joints: Floats) -> Floats:
    """(n, 8, 4, 4) frames of the base and after each row, for `joints` (n, 7)."""
    found = np.empty((len(joints), 8, 4, 4))
    found[:, 0] = np.array(arm.base)
    steps = _rows(arm, joints)
    for row in range(7):
        found[:, row + 1] = found[:, row] @ steps[:, row]
    return found


def forward(arm: Arm, joints: Floats) -> Floats:
    """(n, 4, 4) tool frames for `joints` (n, 7)."""
    return tool_of(arm, frames(arm, joints)[:, 7])


def tool_of(arm: Arm, last: Floats) -> Floats:
    """(n, 4, 4) tool frames for those of the last joint: ahead by the tool's length, and turned upright."""
    turned: Floats = last @ np.array(_mount(arm))
    return turned


def inverse(arm: Arm, targets: Floats, swivels: Floats, branches: Floats) -> Floats:
    """(n, 7) joints that bring the tool to `targets` (n, 4, 4), NaN where none within the limits do.

    `swivels` (n,) are turns of the elbow about the line from shoulder to wrist, radians; `branches` (n, 3)
    rows of `BRANCHES`.
    """
    goal = np.linalg.inv(np.array(arm.base)) @ targets @ np.linalg.inv(np.array(_mount(arm)))
    wrist = goal[:, :3, 3] - arm.lengths[6] * goal[:, :3, 2]
    reach = np.linalg.norm(wrist, axis=1)
    elbow = _elbow(arm, reach, branches[:, 0])
    ahead, up = _wrist_in_upper_arm(arm, elbow)
    azimuth = np.arctan2(wrist[:, 1], wrist[:, 0])
    polar = np.arctan2(np.hypot(wrist[:, 0], wrist[:, 1]), wrist[:, 2])
    upper = _turn_z(azimuth) @ _turn_y(polar) @ _turn_z(swivels) @ _turn_y(-np.arctan2(ahead, up))
    shoulder = _zyz(upper, branches[:, 1])
    fore = upper @ _turn_y(elbow)
    hand = _zyz(np.swapaxes(fore, 1, 2) @ goal[:, :3, :3], branches[:, 2])
    return _within(arm, np.column_stack((shoulder, elbow, hand)))


def everywhere(arm: Arm, targets: Floats) -> Floats:
    """(n, 48, 8, 7) all solutions for `targets` (n, 4, 4), by swivel and branch; NaN where there is none."""
    count, swivels, branches = len(targets), len(SWIVELS), len(BRANCHES)
    each = swivels * branches
    solutions = inverse(
        arm,
        np.repeat(targets, each, axis=0),
        np.tile(np.repeat(SWIVELS, branches), count),
        np.tile(BRANCHES, (count * swivels, 1)),
    )
    return solutions.reshape(count, swivels, branches, 7)


def swivel_of(arm: Arm, joints: Floats) -> tuple[float, Floats]:
    """The swivel and the branch (3,) by which `inverse` finds `joints` (7,) again."""
    turns = joints[None]
    upper = _turn_z(turns[:, 0]) @ _turn_y(turns[:, 1]) @ _turn_z(turns[:, 2])
    ahead, up = _wrist_in_upper_arm(arm, turns[:, 3])
    line = (upper @ _turn_y(np.arctan2(ahead, up)))[0]
    swivel = np.arctan2(line[2, 1], -line[2, 0])
    branch = np.where((joints[3] - _straight_elbow(arm), joints[1], joints[5]) >= np.zeros(3), 1.0, -1.0)
    return float(swivel), branch


def costs(arm: Arm, joints: Floats) -> Floats:
    """(...,) how far `joints` (..., 7) are from the posture, and how near their limits; infinite for NaN."""
    low, high = np.array(arm.low), np.array(arm.high)
    away = (joints - np.array(arm.posture)) / (high - low)
    margin = np.minimum(joints - low, high - joints) / (high - low)
    total = (away**2).sum(axis=-1) + (np.maximum(0, 0.1 - margin) * 10).sum(axis=-1)
    finite: Floats = np.where(np.isnan(total), np.inf, total)
    return finite


def why_not(arm: Arm, target: Floats) -> str:
    """The reason that `inverse` finds nothing for one tool frame (4, 4)."""
    goal = np.linalg.inv(np.array(arm.base)) @ target @ np.linalg.inv(np.array(_mount(arm)))
    reach = float(np.linalg.norm(goal[:3, 3] - arm.lengths[6] * goal[:3, 2]))
    upper, lower = np.hypot(arm.offsets[2], arm.lengths[2]), np.hypot(arm.offsets[3], arm.lengths[4])
    if reach > upper + lower:
        return f"{100 * (reach - upper - lower):.1f} cm too far"
    return "too near the shoulder" if reach < abs(upper - lower) else "a joint would pass its limit"


def _mount(arm: Arm) -> tuple[tuple[float, ...], ...]:
    return (1, 0, 0, 0), (0, -1, 0, 0), (0, 0, -1, arm.tool), (0, 0, 0, 1)


def _rows(arm: Arm, joints: Floats) -> Floats:
    """(n, 7, 4, 4) of each joint's turn and row."""
    cos, sin = np.cos(joints), np.sin(joints)
    twist, lift = np.cos(TWISTS), np.sin(TWISTS)
    steps = np.zeros((*joints.shape, 4, 4))
    steps[..., 0, 0], steps[..., 0, 1], steps[..., 0, 2] = cos, -sin * twist, sin * lift
    steps[..., 1, 0], steps[..., 1, 1], steps[..., 1, 2] = sin, cos * twist, -cos * lift
    steps[..., 2, 1], steps[..., 2, 2], steps[..., 3, 3] = lift, twist, 1
    steps[..., 0, 3], steps[..., 1, 3] = np.array(arm.offsets) * cos, np.array(arm.offsets) * sin
    steps[..., 2, 3] = np.array(arm.lengths)
    return steps


def _elbow(arm: Arm, reach: Floats, branch: Floats) -> Floats:
    """(n,) elbow angles that bring the wrist so far from the shoulder; NaN where none does."""
    (ax, az), (bx, bz) = (arm.offsets[2], arm.lengths[2]), (arm.offsets[3], arm.lengths[4])
    wanted = (reach**2 - ax**2 - az**2 - bx**2 - bz**2) / 2
    with np.errstate(invalid="ignore"):
        bend = np.arccos(wanted / (np.hypot(ax, az) * np.hypot(bx, bz)))
    angle: Floats = _straight_elbow(arm) + branch * bend
    return angle


def _straight_elbow(arm: Arm) -> float:
    """The angle of joint 4 at which the wrist is farthest from the shoulder."""
    (ax, az), (bx, bz) = (arm.offsets[2], arm.lengths[2]), (arm.offsets[3], arm.lengths[4])
    return float(np.arctan2(ax * bz - az * bx, ax * bx + az * bz))


def _wrist_in_upper_arm(arm: Arm, elbow: Floats) -> tuple[Floats, Floats]:
    """x and z (n,) of the wrist in the frame of the upper arm, where the shoulder is the origin and y is
    0."""
    x, z = arm.offsets[3], arm.lengths[4]
    cos, sin = np.cos(elbow), np.sin(elbow)
    return arm.offsets[2] + x * cos + z * sin, arm.lengths[2] - x * sin + z * cos


def _zyz(turns: Floats, branch: Floats) -> Floats:
    """(n, 3) angles about z, y and z that make `turns` (n, 3, 3), the middle one with the branch's sign."""
    middle = branch * np.arctan2(np.hypot(turns[:, 0, 2], turns[:, 1, 2]), turns[:, 2, 2])
    first = np.arctan2(branch * turns[:, 1, 2], branch * turns[:, 0, 2])
    last = np.arctan2(branch * turns[:, 2, 1], -branch * turns[:, 2, 0])
    return np.stack((first, middle, last), axis=1)


def _within(arm: Arm, joints: Floats) -> Floats:
    """Angles within the limits, whole turns aside; a row with one that can't be is NaN throughout."""
    low, high = np.array(arm.low), np.array(arm.high)
    turned: Floats = low + (joints - low) % (2 * np.pi)
    turned[~(turned <= high).all(axis=1)] = np.nan
    return turned


def _turn_z(angles: Floats) -> Floats:
    cos, sin, turns = np.cos(angles), np.sin(angles), np.zeros((len(angles), 3, 3))
    turns[:, 0, 0], turns[:, 0, 1], turns[:, 1, 0], turns[:, 1, 1], turns[:, 2, 2] = cos, -sin, sin, cos, 1
    return turns


def _turn_y(angles: Floats) -> Floats:
    cos, sin, turns = np.cos(angles), np.sin(angles), np.zeros((len(angles), 3, 3))
    turns[:, 0, 0], turns[:, 0, 2], turns[:, 2, 0], turns[:, 2, 2], turns[:, 1, 1] = cos, sin, -sin, cos, 1
    return turns
