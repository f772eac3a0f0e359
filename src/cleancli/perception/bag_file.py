"""Bags of ROS 1 (.bag) and ROS 2 (.mcap, .db3) opened as what anybody may have written.

rosbags is an extra, and is imported here alone. Its readers of folders are passed by: a bag's own definitions
of messages would become code, and files that it lists would be unpacked to disk. The messages that are read
here are those of ROS's own packages, whose fields are known.
"""

from __future__ import annotations

import bz2
import importlib
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

from cleancli.files.numbered import by_numbers
from cleancli.files.plain import in_units, open_plain
from cleancli.perception.frame_source import BadRecording

KINDS = (".bag", ".mcap", ".db3")
LARGEST_CHUNK = 256 << 20
"""Bytes of a part of a bag that is compressed as one; ROS makes them of one to some ten MB."""
ZSTD = b"\x28\xb5\x2f\xfd"

_MENDS = "if its recording was cut off, `rosbag reindex`, `ros2 bag reindex` or `mcap recover` mends it"
_TRANSFORMS = "geometry_msgs/TransformStamped[] transforms"


class MissingBags(Exception):
    """rosbags isn't installed."""

    def __init__(self) -> None:
        super().__init__("reading bags needs rosbags: pip install 'rosbags>=0.11.9,<0.12'")


def find_rosbags() -> Any:
    """Its package. Raises MissingBags."""
    try:
        return importlib.import_module("rosbags")
    except ModuleNotFoundError as error:
        if error.name is None or error.name.split(".")[0] != "rosbags":
            raise
        raise MissingBags from error


class Place(NamedTuple):
    """Where a message is: in which file of the bag, when it was received (nanoseconds), and which one it is
    of those of its topic that were received then."""

    part: int
    received: int
    number: int


@dataclass(frozen=True, slots=True)
class Topic:
    """What ROS calls its messages' type (`sensor_msgs/msg/Image`), and how many there are."""

    kind: str
    count: int


@dataclass(frozen=True, slots=True)
class Message:
    """`content` has the fields that ROS gives its type, in the spelling of its version."""

    topic: str
    place: Place
    content: Any


@dataclass(frozen=True, slots=True)
class _Part:
    """A file of a bag; `decode` makes a message of bytes and its type."""

    reader: Any
    decode: Any


class Bag:
    """An open bag: its topics, and messages one at a time."""

    def __init__(self, path: Path, parts: Sequence[_Part]) -> None:
        self._path, self._parts = path, parts
        self.topics: dict[str, Topic] = {}
        for part in parts:
            for one in part.reader.connections:
                before = self.topics.get(one.topic)
                count = one.msgcount + (before.count if before else 0)
                self.topics[one.topic] = Topic(before.kind if before else one.msgtype, count)

    def messages(self, names: Sequence[str], at: Place | None = None) -> Iterator[Message]:
        """All of some topics as each file has them, or those alone that its file received at one time. Raises
        BadRecording."""
        parts = range(len(self._parts)) if at is None else (at.part,)
        span = {} if at is None else {"start": at.received, "stop": at.received + 1}
        for number in parts:
            reader, decode = self._parts[number].reader, self._parts[number].decode
            wanted = [
                one
                for one in reader.connections
                if one.topic in names and one.msgtype == self.topics[one.topic].kind
            ]
            if not wanted:
                continue
            last: dict[str, Place] = {}
            with _told(self._path):
                for one, received, data in reader.messages(connections=wanted, **span):
                    _refuse_packed(self._path, data)
                    before = last.get(one.topic)
                    again = before is not None and before.received == received
                    place = Place(number, received, before.number + 1 if before and again else 0)
                    last[one.topic] = place
                    yield Message(one.topic, place, decode(data, one.msgtype))

    def first(self, name: str) -> Any:
        """The first message's content. Raises BadRecording."""
        for message in self.messages([name]):
            return message.content
        raise BadRecording(f"{self._path}: no message in {name}, though its index tells of some")

    def message(self, name: str, place: Place) -> Any:
        """The content of one message. Raises BadRecording."""
        for message in self.messages([name], place):
            if message.place == place:
                return message.content
        raise BadRecording(f"{self._path}: it was changed while it was read")


def files_of(path: Path) -> tuple[Path, ...]:
    """The files of a bag: itself, or those of its folder in the order of their numbers."""
    if not path.is_dir():
        return (path,)
    return tuple(sorted((each for each in path.iterdir() if each.suffix in KINDS), key=by_numbers))


@contextmanager
def opened(path: Path) -> Iterator[Bag]:
    """A bag, which may have several files. Raises MissingBags, OSError, and so BadRecording."""
    find_rosbags()
    files = files_of(path)
    with ExitStack() as stack:
        parts = []
        for file in files:
            open_plain(file).close()
            with _told(file):
                parts.append(_part(file, stack))
        yield Bag(path, parts)


def _part(file: Path, stack: ExitStack) -> _Part:
    """Raises what rosbags raises."""
    _limit_chunks()
    types = importlib.import_module("rosbags.typesys")
    is_first = file.suffix == ".bag"
    store = types.get_typestore(types.Stores.ROS1_NOETIC if is_first else types.Stores.ROS2_HUMBLE)
    if is_first:
        for name in ("tf2_msgs/msg/TFMessage", "tf/msg/tfMessage"):
            store.register(types.get_types_from_msg(_TRANSFORMS, name))
    package = importlib.import_module("rosbags.rosbag1" if is_first else "rosbags.rosbag2")
    reader = stack.enter_context(package.Reader(file))
    return _Part(reader, store.deserialize_ros1 if is_first else store.deserialize_cdr)


@contextmanager
def _told(path: Path) -> Iterator[None]:
    """Whatever goes wrong in a file that anybody may have written is told of that file: of damaged ones,
    rosbags raises errors of any type, and those of the system without a name."""
    try:
        yield
    except Exception as error:
        if isinstance(error, BadRecording) or (isinstance(error, OSError) and error.filename is not None):
            raise
        reason = str(error).rstrip(".") or type(error).__name__
        raise BadRecording(f"{path}: the bag cannot be read ({reason}); {_MENDS}") from error


def _refuse_packed(path: Path, data: bytes) -> None:
    if data[:4] == ZSTD:
        raise BadRecording(f"{path}: each message is compressed by itself: `ros2 bag convert` unpacks them")


def _limit_chunks() -> None:
    """Have rosbags unpack no more than `LARGEST_CHUNK`, or than a chunk says of itself: a few bytes may be
    the packed form of more than memory."""
    first = importlib.import_module("rosbags.rosbag1.reader")
    second = importlib.import_module("rosbags.rosbag2.storage_mcap")
    lz4 = importlib.import_module("lz4.frame").LZ4FrameDecompressor
    zstd = second.zstd.ZstdDecompressor
    first.decompressors.update(bz2=_unpacking(bz2.BZ2Decompressor), lz4=_unpacking(lz4))
    second.DECOMPRESSORS.update(lz4=_unpacking(lz4), zstd=_unpacking(zstd))


def _unpacking(decompressor: Any) -> Any:
    def unpack(data: bytes, size: int = LARGEST_CHUNK) -> bytes:
        if size > LARGEST_CHUNK:
            raise ValueError(f"a chunk of it is larger than {in_units(LARGEST_CHUNK)}")
        started = decompressor()
        unpacked: bytes = started.decompress(data, max_length=size + 1)
        if len(unpacked) > size:
            raise ValueError(f"a chunk of it unpacks to more than {in_units(size)}")
        if not started.eof:
            raise ValueError("a chunk of it is cut off")
        return unpacked

    return unpack
