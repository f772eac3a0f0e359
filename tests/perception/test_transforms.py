"""Poses between stamps, and trees of coordinate frames, against what quaternions are defined to do."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest
from scipy.spatial.transform import Rotation, Slerp

from cleancli.array_types import Floats
from cleancli.perception.transforms import STALE, NoTransform, Transforms, track


def test_a_pose_between_two_stamps_is_between_their_poses() -> None:
    """For turns of some degrees, which is what passes between two stamps, the shorter way round."""
    turns = Rotation.from_rotvec([[0.3, 0.2, 0.1], [0.35, 0.15, 0.1], [0.4, 0.2, 0.2]])
    quaternions = turns.as_quat() * np.array([[1.0], [-1.0], [1.0]])
    places = np.array([[0.0, 0, 0], [1, 2, 3], [2, 2, 2]])
    rows = np.column_stack([[1.0, 2.0, 3.0], places, quaternions])
    path = track(rows[[2, 0, 1]])
    assert path is not None
    between = Slerp([1.0, 2.0, 3.0], turns)
    for stamp in (1.0, 1.3, 1.5, 2.0, 2.9, 3.0):
        pose = path.at(stamp)
        assert pose is not None
        np.testing.assert_allclose(pose[:3, :3], between(stamp).as_matrix(), atol=2e-4)
        expected = [np.interp(stamp, [1, 2, 3], column) for column in places.T]
        np.testing.assert_allclose(pose[:3, 3], expected, atol=1e-12)


def test_a_track_holds_a_little_longer_than_it_reaches_and_a_fixed_one_always() -> None:
    row = np.array([[5.0, 1, 2, 3, 0, 0, 0, 1]])
    moving, fixed = track(row), track(row, is_fixed=True)
    assert moving is not None
    assert fixed is not None
    assert moving.at(5 - STALE) is not None
    assert moving.at(5.01 + STALE) is None
    assert fixed.at(1e9) is not None


@pytest.mark.parametrize(
    "broken",
    [[np.nan, 0, 0, 0, 0, 0, 1], [0, 0, 0, 0, 0, 0, 0], [0, 0, 0, 2, 0, 0, 1], [1e300, 0, 0, 0, 0, 0, 1]],
)
def test_what_is_no_pose_is_left_out(broken: list[float]) -> None:
    assert track(np.array([[1.0, *broken]])) is None


def _random_row(rng: np.random.Generator) -> tuple[float, ...]:
    return (0.0, *rng.normal(size=3), *Rotation.random(random_state=int(rng.integers(1000))).as_quat())


def _product(p: Sequence[float], q: Sequence[float]) -> list[float]:
    """Of two quaternions x y z w, by Hamilton's rule."""
    a, b, c, d = p
    e, f, g, h = q
    return [
        d * e + a * h + b * g - c * f,
        d * f - a * g + b * h + c * e,
        d * g + a * f - b * e + c * h,
        d * h - a * e - b * f - c * g,
    ]


def _matrix(row: tuple[float, ...]) -> Floats:
    """The pose whose rotation takes v to q v q*, q being the quaternion and q* its conjugate."""
    pose, turn = np.eye(4), row[4:]
    conjugate = [-turn[0], -turn[1], -turn[2], turn[3]]
    for axis in range(3):
        pose[:3, axis] = _product(_product(turn, [*np.eye(3)[axis], 0.0]), conjugate)[:3]
    pose[:3, 3] = row[1:4]
    return pose


def test_a_way_goes_up_to_the_shared_frame_and_down_again() -> None:
    rng = np.random.default_rng(2)
    parents = {"camera": "hand", "hand": "base", "base": "room", "table": "room", "cloth": "table"}
    rows = {name: _random_row(rng) for name in parents}
    tree = Transforms()
    for child, parent in parents.items():
        tree.add(parent, child, rows[child], is_fixed=True)
    assert len(tree) == 5
    in_room = _matrix(rows["base"]) @ _matrix(rows["hand"]) @ _matrix(rows["camera"])
    cloth = _matrix(rows["table"]) @ _matrix(rows["cloth"])
    for target, expected in (
        ("room", in_room),
        ("cloth", np.linalg.inv(cloth) @ in_room),
        ("hand", _matrix(rows["camera"])),
        ("camera", np.eye(4)),
    ):
        found = tree.way(target, "camera").at(3.0)
        assert found is not None
        np.testing.assert_allclose(found, np.asarray(expected), atol=1e-12)
    with pytest.raises(NoTransform, match="no way from `camera` to `moon`"):
        tree.way("moon", "camera")
