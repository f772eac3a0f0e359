"""Frames from bags: which topics they come from, where the camera was, and which pictures belong together."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path, PurePosixPath
from typing import Any

from cleancli.geometry.rgbd import Frame
from cleancli.language.diagnostics.sink import meant
from cleancli.perception.bag_file import Bag, Message, Place, opened
from cleancli.perception.frame_source import BadRecording, FrameSource, nearest_pairs, unpaired
from cleancli.perception.lens import Lens, pinhole_frame
from cleancli.perception.reading import Reading
from cleancli.perception.ros_pictures import (
    INFO,
    PACKED,
    PICTURE,
    BadPicture,
    Kind,
    colour_of,
    depth_of,
    frame_of,
    kind_of,
    lens_of,
    stamp_of,
)
from cleancli.perception.transforms import NoTransform, Transforms, Way

TREES = ("tf2_msgs/msg/TFMessage", "tf/msg/tfMessage")
FIXED = "/tf_static"
TRANSPORTS = ("compressed", "compressedDepth")
"""Last parts of the names of topics that are another topic's pictures, compressed."""
MOST_PICTURES, MOST_TRANSFORMS = 1_000_000, 4_000_000
"""Whose stamps are kept in memory, of a topic and of all of tf."""
MOST_LISTED = 20
"""Topics or frames that a message names."""


@dataclass(frozen=True, slots=True)
class _Pictures:
    """A topic with pictures, and what its first one shows."""

    name: str
    count: int
    kind: Kind

    @property
    def of(self) -> str:
        """The topic whose pictures these are, compressed or not."""
        path = PurePosixPath(self.name)
        return str(path.parent) if path.name in TRANSPORTS else self.name

    def __str__(self) -> str:
        return f"{self.name} ({self.kind}, {self.count} messages)"


@dataclass(frozen=True, slots=True)
class _Stamped:
    """Where the pictures of a topic are, and their stamps in seconds."""

    places: list[Place]
    stamps: list[float]


def open_bag(path: Path, reading: Reading) -> FrameSource:
    """The pairs of a bag, whose messages are gone through once for their stamps. Raises MissingBags, OSError,
    and so BadRecording."""
    with opened(path) as bag:
        colour, depth = _chosen(path, bag, reading)
        seen_through = _lens(path, bag, colour, reading)
        stamped, transforms = _index(path, bag, colour.name, depth.name, reading.frame is not None)
    way = None if reading.frame is None else _way(path, transforms, reading.frame, colour.kind.frame)
    one, other = stamped[colour.name], stamped[depth.name]
    pairs = nearest_pairs(one.stamps, other.stamps, reading.max_difference)
    notes = unpaired(path, one.stamps, other.stamps, len(pairs), reading.max_difference)

    clocks = tuple(one.stamps[number] for number, _ in pairs)

    def take(numbers: Sequence[int]) -> Iterator[Frame]:
        with opened(path) as bag:
            for number in numbers:
                first, second = (
                    stamped[topic.name].places[at]
                    for topic, at in zip((colour, depth), pairs[number], strict=True)
                )
                messages = bag.message(colour.name, first), bag.message(depth.name, second)
                yield _frame(path, colour, depth, messages, seen_through, way, clocks[number])

    return FrameSource(path, clocks, colour.kind.width * colour.kind.height, take, notes)


def _frame(
    path: Path,
    colour: _Pictures,
    depth: _Pictures,
    messages: tuple[Any, Any],
    seen_through: Lens,
    way: Way | None,
    clock: float,
) -> Frame:
    try:
        rgb, metres = colour_of(messages[0]), depth_of(messages[1])
    except BadPicture as error:
        raise BadRecording(f"{path}: {colour.name} or {depth.name} at {clock:.3f} s: {error}") from None
    size = (colour.kind.height, colour.kind.width)
    if rgb.shape[:2] != size or metres.shape != size:
        raise BadRecording(f"{path}: at {clock:.3f} s pictures are of another size than before")
    pose = None if way is None else way.at(clock)
    if way is not None and pose is None:
        raise BadRecording(f"{path}: tf does not say where the camera was at {clock:.3f} s")
    return pinhole_frame(rgb, metres, seen_through, pose, clock)


def _chosen(path: Path, bag: Bag, reading: Reading) -> tuple[_Pictures, _Pictures]:
    """The topics of colour and depth: those named, or the only two of one camera."""
    there = list(_readable(bag))
    if reading.colour_topic is None:
        colours = [each for each in there if not each.kind.is_depth and not each.kind.is_grey]
    else:
        colours = [_named(path, bag, reading.colour_topic)]
    if reading.depth_topic is None:
        depths = [each for each in there if each.kind.is_depth]
    else:
        depths = [_named(path, bag, reading.depth_topic)]
    for found, what, option in ((colours, "colour", "--colour-topic"), (depths, "depth", "--depth-topic")):
        if not found:
            raise BadRecording(f"{path}: no topic has pictures of {what} (`{option}`); {_listed(bag, there)}")
    pairs = [(one, other) for one in colours for other in depths if _is_registered(one, other)]
    if not pairs:
        raise BadRecording(
            f"{path}: no depth is registered to colour, with its size and frame: record depth that the "
            f"driver aligns to colour (docs/recording.md); {_listed(bag, there)}"
        )
    # What is not compressed stands for both.
    raw = {(one.of, other.of): (one, other) for one, other in sorted(pairs, key=_packing, reverse=True)}
    if len(raw) > 1:
        raise BadRecording(
            f"{path}: several cameras: choose with `--colour-topic` and `--depth-topic`; "
            f"{_listed(bag, there)}"
        )
    (pair,) = raw.values()
    return pair


def _packing(pair: tuple[_Pictures, _Pictures]) -> tuple[int, str, str]:
    return sum(each.kind.is_packed for each in pair), pair[0].name, pair[1].name


def _is_registered(colour: _Pictures, depth: _Pictures) -> bool:
    one, other = colour.kind, depth.kind
    is_same_frame = one.frame == other.frame or not one.frame or not other.frame
    return (one.width, one.height) == (other.width, other.height) and is_same_frame


def _named(path: Path, bag: Bag, name: str) -> _Pictures:
    there = _of_kind(bag, PICTURE, PACKED)
    if name not in there:
        raise BadRecording(f"{path}: no pictures in a topic `{name}`; {meant(name, there, 'topic')}")
    try:
        return _pictures(bag, name)
    except BadPicture as error:
        raise BadRecording(f"{path}: {name}: {error}") from None


def _readable(bag: Bag) -> Iterator[_Pictures]:
    """Topics whose pictures can be read; others may be of no concern."""
    for name in _of_kind(bag, PICTURE, PACKED):
        with suppress(BadPicture):
            yield _pictures(bag, name)


def _pictures(bag: Bag, name: str) -> _Pictures:
    return _Pictures(name, bag.topics[name].count, kind_of(bag.first(name)))


def _of_kind(bag: Bag, *kinds: str) -> list[str]:
    return sorted(name for name, topic in bag.topics.items() if topic.kind in kinds and topic.count)


def _listed(bag: Bag, there: Sequence[_Pictures]) -> str:
    """What is in the bag: pictures first, and then the names of all else."""
    named = {each.name for each in there}
    others = [f"{name} ({topic.kind})" for name, topic in sorted(bag.topics.items()) if name not in named]
    told = [*map(str, there), *others]
    more = f"; and {len(told) - MOST_LISTED} more" if len(told) > MOST_LISTED else ""
    return f"there are: {'; '.join(told[:MOST_LISTED])}{more}" if told else "it has no topic"


def _lens(path: Path, bag: Bag, colour: _Pictures, reading: Reading) -> Lens:
    """Of the topic named, of `camera_info` beside the pictures, or of the only one with their frame and
    size."""
    name = _info_topic(path, bag, colour, reading)
    info = bag.first(name)
    size = (colour.kind.width, colour.kind.height)
    if (info.width, info.height) != size:
        raise BadRecording(
            f"{path}: {name} is of {info.width} x {info.height} pixels, and {colour.name} of "
            f"{size[0]} x {size[1]}"
        )
    try:
        # ROS names topics of rectified pictures so (REP 118, image_proc): P is theirs, and K of the raw ones.
        return lens_of(info, PurePosixPath(colour.of).name.startswith("image_rect"))
    except BadPicture as error:
        raise BadRecording(f"{path}: {name}: {error}") from None


def _info_topic(path: Path, bag: Bag, colour: _Pictures, reading: Reading) -> str:
    there = _of_kind(bag, INFO)
    beside = str(PurePosixPath(colour.of).parent / "camera_info")
    name = reading.info_topic or beside
    if name in there:
        return name
    if reading.info_topic is not None:
        raise BadRecording(f"{path}: no camera_info in a topic `{name}`; {meant(name, there, 'topic')}")
    fitting = [
        each
        for each in there
        if frame_of((info := bag.first(each)).header.frame_id) == colour.kind.frame
        and (info.width, info.height) == (colour.kind.width, colour.kind.height)
    ]
    if len(fitting) != 1:
        known = f"there are {', '.join(there)} (`--info-topic`)" if there else "record it too"
        raise BadRecording(f"{path}: no camera_info of {colour.name}: neither {beside} nor another; {known}")
    return fitting[0]


def _index(
    path: Path, bag: Bag, colour: str, depth: str, with_tf: bool
) -> tuple[dict[str, _Stamped], Transforms]:
    """Where the pictures of both topics are, and all of tf if it is asked for."""
    stamped = {name: _Stamped([], []) for name in (colour, depth)}
    transforms = Transforms()
    asked = [colour, depth, *(_of_kind(bag, *TREES) if with_tf else ())]
    for message in bag.messages(asked):
        if message.topic in stamped:
            one = stamped[message.topic]
            one.places.append(message.place)
            # A driver that knows no time leaves the stamp at 0.
            one.stamps.append(stamp_of(message.content) or message.place.received / 1e9)
        else:
            _add(transforms, message)
        if max(len(one.stamps) for one in stamped.values()) > MOST_PICTURES:
            raise BadRecording(f"{path}: more than {MOST_PICTURES} pictures; cut it (`rosbag filter`)")
        if len(transforms) > MOST_TRANSFORMS:
            raise BadRecording(f"{path}: more than {MOST_TRANSFORMS} transforms; cut it (`rosbag filter`)")
    return stamped, transforms


def _add(transforms: Transforms, message: Message) -> None:
    for one in message.content.transforms:
        place, turn = one.transform.translation, one.transform.rotation
        row = (stamp_of(one), place.x, place.y, place.z, turn.x, turn.y, turn.z, turn.w)
        parent, child = frame_of(one.header.frame_id), frame_of(one.child_frame_id)
        transforms.add(parent, child, row, message.topic == FIXED)


def _way(path: Path, transforms: Transforms, target: str, source: str) -> Way:
    try:
        return transforms.way(frame_of(target), source)
    except NoTransform as error:
        names = transforms.names
        there = f"frames: {', '.join(names[:MOST_LISTED])}" if names else "no tf was recorded"
        raise BadRecording(f"{path}: {error} (`--frame`); {there}") from None
