"""Folders in the layout of the TUM RGB-D benchmark: lists of pictures with their stamps, the camera's path.

`rgb.txt` and `depth.txt` have a stamp and a file's name on each line, `associations.txt` has both for a pair,
`groundtruth.txt` a stamp, a place and a quaternion (x y z w) of the camera in the scene. The layout says
nothing of the lens, which `camera.json` tells as it does for frames of our own.
"""

from __future__ import annotations

import json
import math
from collections.abc import Iterator, Sequence
from pathlib import Path, PurePosixPath

import cv2
import numpy as np
from scipy.spatial.transform import Rotation

from cleancli.files.plain import read_plain
from cleancli.files.replace import replace_file
from cleancli.geometry.rgbd import Frame
from cleancli.perception.camera_file import CAMERA, CameraFile, lens_of, read_camera_file
from cleancli.perception.frame_source import (
    BadRecording,
    FrameSource,
    nearest_pairs,
    unpaired,
)
from cleancli.perception.lens import pinhole_frame
from cleancli.perception.reading import Reading
from cleancli.perception.recorded import read_png
from cleancli.perception.transforms import COLUMNS, Track, track

DEPTH_SCALE = 5000.0
"""Steps of a depth picture to a metre, unless `camera.json` says otherwise."""
LARGEST_LIST = 64 << 20
"""Bytes: a million lines."""
DEPTH_BITS = (1 << 16) - 1

COLOUR, DEPTH, PATH, PAIRS = "rgb.txt", "depth.txt", "groundtruth.txt", "associations.txt"

_Named = tuple[float, str]


def is_tum(folder: Path) -> bool:
    """Whether a folder has lists of pictures."""
    return (folder / COLOUR).exists() or (folder / PAIRS).exists()


def open_tum(folder: Path, reading: Reading) -> FrameSource:
    """The pairs of a folder. Raises OSError, and so BadRecording."""
    described = _camera(folder)
    notes: tuple[str, ...] = ()
    if (folder / PAIRS).exists():
        pairs = _associated(folder / PAIRS)
    else:
        pairs, notes = _nearest(folder, reading.max_difference)
    path = _path(folder / PATH) if (folder / PATH).exists() else None

    def take(numbers: Sequence[int]) -> Iterator[Frame]:
        for number in numbers:
            colour, depth = pairs[number]
            yield _frame(folder, described, colour, depth[1], path)

    clocks = tuple(colour[0] for colour, _ in pairs)
    return FrameSource(folder, clocks, described.width * described.height, take, notes)


def save_tum(frames: Sequence[Frame], folder: Path) -> None:
    """Write frames of one camera into `folder`, which is made if it is missing. Raises OSError."""
    lists: dict[str, list[str]] = {COLOUR: [], DEPTH: [], PAIRS: [], PATH: []}
    for name in ("rgb", "depth"):
        (folder / name).mkdir(parents=True, exist_ok=True)
    for number, frame in enumerate(frames):
        stamp = f"{frame.clock:.6f}"
        steps = np.where(np.isfinite(frame.depth), frame.depth, 0) * DEPTH_SCALE
        depth = np.rint(np.where((steps > 0) & (steps <= DEPTH_BITS), steps, 0)).astype(np.uint16)
        bgr = cv2.cvtColor(frame.colour, cv2.COLOR_RGB2BGR)
        pictures = (COLOUR, f"rgb/{number:03}.png", bgr), (DEPTH, f"depth/{number:03}.png", depth)
        for name, file, image in pictures:
            _, data = cv2.imencode(".png", image)
            replace_file(folder / file, data.tobytes())
            lists[name].append(f"{stamp} {file}")
        lists[PAIRS].append(f"{lists[COLOUR][-1]} {lists[DEPTH][-1]}")
        pose = frame.camera.pose
        numbers = (*pose[:3, 3], *Rotation.from_matrix(pose[:3, :3]).as_quat())
        lists[PATH].append(" ".join([stamp, *(f"{number:.9g}" for number in numbers)]))
    camera = frames[0].camera
    if not camera.located:
        del lists[PATH]
    for name, lines in lists.items():
        replace_file(folder / name, "\n".join(lines) + "\n")
    described = {
        "width": camera.width,
        "height": camera.height,
        "focal": camera.focal,
        "centre": list(camera.centre),
        "depth_scale": DEPTH_SCALE,
    }
    replace_file(folder / CAMERA, json.dumps(described, indent=2) + "\n")


def _camera(folder: Path) -> CameraFile:
    path = folder / CAMERA
    if not path.exists():
        raise BadRecording(
            f"{path}: missing. The TUM layout says nothing of the lens; write the camera's own numbers, as "
            '{"width": 640, "height": 480, "focal": [525.0, 525.0], "centre": [319.5, 239.5]}'
        )
    read = read_camera_file(path)
    for key, place in (("pose", PATH), ("clocks", COLOUR)):
        if getattr(read, key) is not None:
            raise BadRecording(f"{path}: in a folder with {COLOUR}, {place} tells the `{key}`")
    return read


def _nearest(folder: Path, max_difference: float) -> tuple[list[tuple[_Named, _Named]], tuple[str, ...]]:
    if not (folder / DEPTH).exists():
        raise BadRecording(f"{folder / DEPTH}: missing, though there is {COLOUR}")
    colour, depth = _named(folder / COLOUR), _named(folder / DEPTH)
    stamps, others = [stamp for stamp, _ in colour], [stamp for stamp, _ in depth]
    numbers = nearest_pairs(stamps, others, max_difference)
    notes = unpaired(folder, stamps, others, len(numbers), max_difference)
    return [(colour[one], depth[other]) for one, other in numbers], notes


def _associated(path: Path) -> list[tuple[_Named, _Named]]:
    pairs = []
    for number, words in _lines(path, 4):
        one, other = (_entry(path, number, words[at : at + 2]) for at in (0, 2))
        pairs.append((one, other))
    if not pairs:
        raise BadRecording(f"{path}: no pair of pictures")
    return sorted(pairs)


def _named(path: Path) -> list[_Named]:
    found = [_entry(path, number, words) for number, words in _lines(path, 2)]
    if not found:
        raise BadRecording(f"{path}: no picture")
    return found


def _entry(path: Path, number: int, words: Sequence[str]) -> _Named:
    """A stamp and a name; one that leads out of the folder would read what was never meant to be given."""
    (stamp,) = _numbers(path, number, words[:1])
    name = PurePosixPath(words[1])
    if name.is_absolute() or ".." in name.parts:
        raise BadRecording(f"{path}: line {number}: `{name}` lies outside of the folder")
    return stamp, str(name)


def _path(path: Path) -> Track:
    rows = [_numbers(path, number, words) for number, words in _lines(path, COLUMNS)]
    found = track(np.array(rows, dtype=np.float64)) if rows else None
    if found is None:
        raise BadRecording(f"{path}: no place of the camera: stamp, x y z, quaternion x y z w of length 1")
    return found


def _lines(path: Path, columns: int) -> Iterator[tuple[int, list[str]]]:
    """The words of each line that is no comment, with its number."""
    try:
        text = read_plain(path, LARGEST_LIST).decode("utf-8")
    except UnicodeDecodeError:
        raise BadRecording(f"{path}: no text") from None
    for number, line in enumerate(text.splitlines(), start=1):
        words = line.split()
        if not words or words[0].startswith("#"):
            continue
        if len(words) != columns:
            raise BadRecording(f"{path}: line {number}: {columns} words are asked for, not {len(words)}")
        yield number, words


def _numbers(path: Path, number: int, words: Sequence[str]) -> tuple[float, ...]:
    try:
        found = tuple(map(float, words))
    except ValueError as error:
        raise BadRecording(f"{path}: line {number}: {error}") from None
    if not all(map(math.isfinite, found)):
        raise BadRecording(f"{path}: line {number}: all numbers must be finite")
    return found


def _frame(folder: Path, described: CameraFile, colour: _Named, depth: str, path: Track | None) -> Frame:
    shape = (described.height, described.width)
    bgr = read_png(folder / colour[1], (*shape, 3), np.uint8)
    steps = read_png(folder / depth, shape, np.uint16)
    pose = None if path is None else path.at(colour[0])
    if path is not None and pose is None:
        raise BadRecording(f"{folder / PATH}: no place of the camera for {colour[1]}")
    metres = steps.astype(np.float64) / (described.depth_scale or DEPTH_SCALE)
    rgb = cv2.cvtColor(bgr, cv2.COLOR_BGR2RGB).astype(np.uint8)
    return pinhole_frame(rgb, metres, lens_of(described, folder / CAMERA), pose, colour[0])
