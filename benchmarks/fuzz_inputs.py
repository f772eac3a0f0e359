"""What benchmarks/fuzz_commands.py mutates: pairs of a domain and a problem, scenes, run folders, frames.

Everything is drawn from a random generator that is given; nothing here runs a command.
"""

from __future__ import annotations

import contextlib
import copy
import functools
import hashlib
import io
import json
import os
import random
import re
import shutil
import struct
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, AnyStr

import numpy as np

from cleancli.language.diagnostics.refused import Refused
from cleancli.language.load import domain_named, kind_of, load_domain, load_problem, read_source

ROOT = Path(__file__).resolve().parents[1]
FOLDERS = ("domains", "problems", "tests/golden", "tests/language", "tests/conversion", "tests/cases", "src")
TOKEN = re.compile(r"#[^\r\n]*|\?\w+|\w+(?:\.\d+)?|:=|=>|[<>!+-]=|\s+|.", re.DOTALL)
NUMBERS = ("0", "1", "2", "7", "60", "1000", "100000", "0.5", "1/3", "-1", "0.0001", "99999999999")
VALUES: tuple[Any, ...] = (
    None, True, False, 0, 1, -1, 2**31, 2**63, 10**30, 0.5, -1e-9, 1e9, 1e300, "", "x", "a1", "\x1b[2J",
    "é" * 999, "../elsewhere", "/etc/hostname", "1/0", "1e999999999", [], {}, [[]], [None], {"": {}},
    ["a1"] * 999, "x" * 100_000,
)  # fmt: skip
WORDS = (
    "default",
    "goal",
    "rest: noise",
    "rest: nothing",
    "forall",
    "exists",
    "not",
    "when",
    "count",
    "closure",
)
MANY = 20_000
"""Parts of a value that become no more."""
LONG = 1 << 28
"""Bytes of a file that changes leave alone."""


# ---- texts


@functools.cache
def pairs() -> tuple[tuple[str, str], ...]:
    """Texts of a domain and of a problem of it, without mistakes: all that the checkout has."""
    domains: dict[str, list[Path]] = {}
    problems: list[Path] = []
    for path in sorted(path for folder in FOLDERS for path in (ROOT / folder).rglob("*.nid")):
        with contextlib.suppress(Refused):
            source = read_source(path)
            match kind_of(source):
                case "domain":
                    domains.setdefault(load_domain(source).name, []).append(path)
                case "problem":
                    problems.append(path)
    return tuple(_paired(domains, problems))


def _paired(domains: dict[str, list[Path]], problems: list[Path]) -> Iterator[tuple[str, str]]:
    for path in problems:
        with contextlib.suppress(Refused):
            source = read_source(path)
            found = domains.get(domain_named(source).text, [])
            for domain in sorted(found, key=lambda each: len(os.path.relpath(each, path)))[:1]:
                load_problem(source, load_domain(read_source(domain)))
                yield domain.read_text(encoding="utf-8"), source.text


@functools.cache
def scenes() -> tuple[str, ...]:
    """The shipped scenes that are quick to look at, and one of every setting."""
    return tuple((ROOT / "problems" / f"{name}.nid").read_text() for name in ("two_groups", "wam_groups"))


def text(source: str, rng: random.Random) -> str:
    """A text with one to three small changes: most still parse, and many still pass the check."""
    for _ in range(rng.choice((1, 1, 1, 2, 3))):
        source = rng.choice(_TEXT)(source, rng)
    return source[:100_000]


def _swapped(source: str, rng: random.Random) -> str:
    """One word in the place of another of its kind."""
    tokens = TOKEN.findall(source)
    if not tokens:
        return source
    first = rng.choice([n for n, token in enumerate(tokens) if re.match(r"[?\w]", token)] or [0])
    alike = [token for token in tokens if token[:1].isdigit() == tokens[first][:1].isdigit() and token != " "]
    same = [token for token in alike if token[:1] == "?" or tokens[first][:1] != "?"]
    tokens[first] = rng.choice(same or tokens)
    return "".join(tokens)


def _number(source: str, rng: random.Random) -> str:
    found = list(re.finditer(r"\b\d+(\.\d+)?\b", source))
    if not found:
        return source
    at = rng.choice(found)
    return source[: at.start()] + rng.choice(NUMBERS) + source[at.end() :]


def _lines(source: str, rng: random.Random) -> str:
    """A line dropped, doubled, moved, or of another file."""
    lines = source.split("\n")
    if rng.random() < 0.25:
        lines.insert(rng.randrange(len(lines)), rng.choice(rng.choice(rng.choice(pairs())).split("\n")))
    else:
        _displaced(lines, rng)
    return "\n".join(lines)


def _displaced(lines: list[AnyStr], rng: random.Random) -> None:
    """One of some lines dropped, doubled or moved."""
    number = rng.randrange(len(lines))
    match rng.randrange(3):
        case 0:
            del lines[number]
        case 1:
            lines.insert(rng.randrange(len(lines)), lines[number])
        case _:
            lines.insert(rng.randrange(len(lines)), lines.pop(number))


def _part(source: str, rng: random.Random) -> str:
    """A literal, an effect or a mark taken out, doubled, negated or given to another place."""
    found = list(re.finditer(r"(not )?\w+\([^()\n]*\)( [:+-]?= ?\w+)?|\[[^]\n]*\]", source))
    if not found:
        return source
    one, other = rng.choice(found), rng.choice(found)
    new = rng.choice(("", f"{one[0]}, {one[0]}", f"not {one[0]}", other[0], f"{one[0]}, {other[0]}"))
    return source[: one.start()] + new + source[one.end() :]


def _word(source: str, rng: random.Random) -> str:
    tokens = TOKEN.findall(source)
    number = rng.randrange(len(tokens))
    if rng.random() < 0.5:
        del tokens[number]
    else:
        tokens.insert(number, f" {rng.choice(WORDS)} ")
    return "".join(tokens)


_TEXT: tuple[Callable[[str, random.Random], str], ...] = (
    *(_swapped,) * 5, *(_number,) * 3, *(_lines,) * 3, *(_part,) * 4, _word,
)  # fmt: skip


# ---- bytes and JSON


def data(content: bytes, rng: random.Random) -> bytes:
    """Bytes cut, lengthened, flipped, zeroed or doubled."""
    start = rng.randrange(len(content) + 1)
    end = min(len(content), start + rng.choice((1, 4, 40, 4000)))
    piece = content[start:end]
    match rng.randrange(7):
        case 0:
            return content[:start]
        case 1:
            return content + rng.choice((b"\0" * 100, b"\n", b"x", content[:1000], b"\xff"))
        case 2:
            piece = b""
        case 3:
            piece = bytes(len(piece))
        case 4:
            piece = bytes(byte ^ (1 << rng.randrange(8)) for byte in piece[:1]) + piece[1:]
        case 5:
            piece *= 2
        case _:
            piece = bytes(rng.randrange(256) for _ in range(min(len(piece), 8)))
    return content[:start] + piece + content[end:]


def value(described: Any, rng: random.Random) -> Any:
    """The JSON value with one part of it replaced, dropped, renamed or doubled."""
    parts = list(_parts(described))
    if not parts:
        return rng.choice(VALUES)
    holder, key = rng.choice(parts)
    small = len(parts) < MANY
    match rng.randrange(6):
        case 0:
            del holder[key]
        case 1 if isinstance(holder, dict):
            holder[rng.choice(("", "format", "x" * 300, "\x07", "rest"))] = holder.pop(key)
        case 2 if small:
            other, name = rng.choice(parts)
            # A copy, since a part may be put into itself.
            holder[key] = copy.deepcopy(other[name])
        case 3 if isinstance(holder[key], int | float) and not isinstance(holder[key], bool):
            holder[key] = rng.choice((-holder[key], holder[key] * 10**6, holder[key] + 1, holder[key] / 7))
        case 4 if small and isinstance(holder, list):
            holder *= rng.choice((2, 50))
        case _:
            holder[key] = rng.choice(VALUES)
    return described


def _parts(described: Any) -> Any:
    """Every object or list with every key of it."""
    keys: Any = range(len(described)) if isinstance(described, list) else ()
    for key in list(described) if isinstance(described, dict) else keys:
        yield described, key
        yield from _parts(described[key])


def json_text(content: bytes, rng: random.Random) -> bytes:
    """A JSON text with a part changed; or its bytes, or something very deep."""
    if rng.random() < 0.15:
        return data(content, rng)
    if rng.random() < 0.03:
        return b'{"format": 1, "seed": ' + rng.choice((b"[", b'{"a":')) * rng.choice((10, 2000, 200_000))
    try:
        described = json.loads(content)
        for _ in range(rng.choice((1, 1, 2, 5))):
            described = value(described, rng)
        return json.dumps(described).encode("utf-8", "surrogatepass")
    except (ValueError, RecursionError):
        return data(content, rng)


def json_lines(content: bytes, rng: random.Random) -> bytes:
    """One line of many changed, moved, doubled or taken out."""
    lines = content.split(b"\n")
    if rng.random() < 0.5:
        number = rng.randrange(len(lines))
        lines[number] = json_text(lines[number], rng)
    else:
        _displaced(lines, rng)
    return b"\n".join(lines)


# ---- arrays and pictures


def arrays(content: bytes, rng: random.Random) -> bytes:
    """A checkpoint with an array or what is written beside the arrays changed."""
    try:
        with np.load(io.BytesIO(content)) as loaded:
            held = {name: loaded[name] for name in loaded.files}
    except Exception:
        return data(content, rng)
    name = rng.choice(sorted(held))
    array = held[name]
    if name == "rest" and rng.random() < 0.9:
        held[name] = np.frombuffer(json_text(array.tobytes(), rng), np.uint8)
    elif array.dtype.kind == "U":
        held[name] = np.array(json_text(str(array).encode(), rng).decode("utf-8", "replace"))
    else:
        held[name] = _array(array, rng)
    file = io.BytesIO()
    np.savez_compressed(file, **held)
    return file.getvalue()


def _array(array: Any, rng: random.Random) -> Any:
    changed = array.copy().reshape(-1)
    match rng.randrange(7):
        case 0 if changed.size:
            numbers = (np.nan, np.inf, -1, 1e300, 1e6, 0) if changed.dtype.kind == "f" else (0, 99)
            changed[rng.randrange(changed.size)] = rng.choice(numbers)
        case 1:
            return array[:-1] if array.ndim else array.reshape(1)
        case 2:
            return array.astype(rng.choice((np.float32, np.int8, np.complex128, "U5", bool)))
        case 3:
            return array[None]
        case 4:
            return np.array([{"a": 1}], object)
        case 5:
            return np.zeros((2000, 2000)) if rng.random() < 0.3 else array.T
        case _:
            # Whole numbers wrap around: a factor that their type cannot hold is an error to numpy.
            wide = changed.astype(np.int64) if changed.dtype.kind in "iu" else changed
            changed = (wide * rng.choice((-1, 2, 1000))).astype(changed.dtype)
    return changed.reshape(array.shape)


def png(content: bytes, rng: random.Random) -> bytes:
    """A picture whose header tells of another size, or whose bytes are changed."""
    if rng.random() < 0.6:
        return data(content, rng)
    side = struct.pack(">I", rng.choice((0, 1, 479, 640, 4096, 65_535, 2**31 - 1, 2**32 - 1)))
    at = rng.choice((16, 20))
    return content[:at] + side + content[at + 4 :]


# ---- folders


def folder(path: Path, elsewhere: Path, rng: random.Random) -> None:
    """Change one to three files of a folder, as a disk, an editor or an enemy may do; links lead
    `elsewhere`."""
    for _ in range(rng.choice((1, 1, 1, 2, 3))):
        files = _small(path)
        if not files:
            return
        file = rng.choice(files)
        if rng.random() < 0.15:
            _disturbed(file, path, elsewhere, rng)
        else:
            file.write_bytes(_changed(file, rng))
            if file.parent.name == "files" and rng.random() < 0.7:
                _agreed(path, file)


def _small(path: Path) -> list[Path]:
    """The files of a folder that can be read whole: no links, which may be endless, and none that a change
    has made very long."""
    files = (each for each in path.rglob("*") if each.is_file() and not each.is_symlink())
    return sorted(each for each in files if each.stat().st_size < LONG)


def _changed(file: Path, rng: random.Random) -> bytes:
    content = file.read_bytes()
    match file.suffix:
        case ".json":
            return json_text(content, rng)
        case ".jsonl":
            return json_lines(content, rng)
        case ".npz":
            return arrays(content, rng) if rng.random() < 0.8 else data(content, rng)
        case ".png":
            return png(content, rng)
        case ".nid":
            return text(content.decode("utf-8", "replace"), rng).encode("utf-8", "surrogatepass")
    return data(content, rng)


def _disturbed(file: Path, top: Path, elsewhere: Path, rng: random.Random) -> None:
    """Something else in the place of a file, or beside it."""
    match rng.randrange(8):
        case 0:
            file.unlink()
        case 1:
            file.unlink()
            file.symlink_to(rng.choice((elsewhere, elsewhere / "text", Path("nowhere"), Path("/dev/zero"))))
        case 2:
            file.unlink()
            os.mkfifo(file)
        case 3:
            file.unlink()
            file.mkdir()
        case 4:
            os.truncate(file, rng.choice((0, 1, 1 << 22, 1 << 34)))
        case 5:
            names = ("step-000.png", "009.npz", "video.mp4", ".cleancli-0123456789abcdef.part")
            file.with_name(rng.choice(names)).write_bytes(file.read_bytes())
        case 6:
            shutil.rmtree(file.parent) if file.parent != top else file.unlink()
        case _:
            file.write_bytes(rng.choice(_small(top)).read_bytes())


def _agreed(path: Path, file: Path) -> None:
    """Let run.json say the hash of a text that was changed, so that the text is read."""
    if path / "run.json" not in _small(path):
        return
    try:
        header = json.loads((path / "run.json").read_bytes())
        for entry in header["files"]:
            if entry["copy"] == f"files/{file.name}":
                entry["sha256"] = hashlib.sha256(file.read_bytes()).hexdigest()
        (path / "run.json").write_text(json.dumps(header))
    except (ValueError, KeyError, TypeError, OSError):
        return
