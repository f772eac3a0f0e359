"""Arrays by name in a file, as numpy keeps them, that somebody else may have written: no code is run, and no
more memory taken than a limit, whatever the file's headers ask for."""

from __future__ import annotations

import io
import math
import zipfile
import zlib
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

LARGEST = 64 << 20
"""Bytes of all arrays together. Chosen: a table with thousands of particles and ink takes less."""

MOST = 64
"""Arrays of a file."""

KINDS = "biufU"
"""Truth values, integers, numbers, texts: none that an array could run code with."""

_ERRORS = (zipfile.BadZipFile, zlib.error, EOFError, OSError, ValueError, RuntimeError, NotImplementedError)
"""What zipfile raises of broken files; the last two are for ciphers and methods that it does not have."""


class BadArrays(Exception):
    """A file that holds no such arrays; the message says what is wrong with it."""


def packed(arrays: Mapping[str, NDArray[Any]]) -> bytes:
    """The arrays as the content of a file."""
    file = io.BytesIO()
    np.savez_compressed(file, allow_pickle=False, **arrays)
    return file.getvalue()


def unpacked(data: bytes) -> dict[str, NDArray[Any]]:
    """The arrays that a file holds, whose content `packed` made. Raises BadArrays."""
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            members = archive.infolist()
            if len(members) > MOST:
                raise BadArrays(f"it lists {len(members)} arrays")
            if sum(member.file_size for member in members) > LARGEST:
                raise BadArrays(f"its arrays are larger than {LARGEST >> 20} MiB")
            return {
                member.filename.removesuffix(".npy"): _array(_content(archive, member), member.filename)
                for member in members
            }
    except _ERRORS as error:
        raise BadArrays(f"it is damaged ({error})") from None


def _content(archive: zipfile.ZipFile, member: zipfile.ZipInfo) -> bytes:
    with archive.open(member) as file:
        content = file.read(member.file_size + 1)
    if len(content) != member.file_size:
        raise BadArrays(f"`{member.filename}` is not as large as it says")
    return content


def _array(content: bytes, name: str) -> NDArray[Any]:
    file = io.BytesIO(content)
    try:
        if np.lib.format.read_magic(file) != (1, 0):
            raise BadArrays(f"`{name}` has a header of another version")
        shape, by_columns, kind = np.lib.format.read_array_header_1_0(file)
    except (SyntaxError, TypeError, RecursionError, MemoryError) as error:
        raise BadArrays(f"the header of `{name}` is damaged ({error})") from None
    if kind.kind not in KINDS or kind.hasobject or not all(0 <= side <= LARGEST for side in shape):
        raise BadArrays(f"`{name}` is no array of numbers or of text")
    if math.prod(shape) * kind.itemsize != len(content) - file.tell():
        raise BadArrays(f"`{name}` is not as large as its header says")
    array = np.frombuffer(content, kind, offset=file.tell()).reshape(shape, order="F" if by_columns else "C")
    if kind.kind == "f" and not np.isfinite(array).all():
        raise BadArrays(f"`{name}` holds what is no number")
    return array.copy()
