"""Opens files that users name: plain files alone, and no more of one than was asked for is ever read.

A pipe keeps its reader waiting, a device may never end, and what lies on a disk can be larger than memory. So
what a path leads to and how large it is are looked at before anything is read.
"""

from __future__ import annotations

import errno
import os
import stat
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import BinaryIO

from cleancli.language.diagnostics.plural import plural

_KINDS = {
    stat.S_IFIFO: "a named pipe",
    stat.S_IFSOCK: "a socket",
    stat.S_IFCHR: "a device",
    stat.S_IFBLK: "a device",
}


def _flags(*names: str) -> int:
    """Those of these flags of `os.open` that this system has."""
    return sum(getattr(os, name, 0) for name in names)


_NO_WAIT = _flags("O_NONBLOCK", "O_NOCTTY", "O_BINARY")


class NotPlain(OSError):
    """A pipe, socket or device; the reason is a sentence about "it"."""


class TooLarge(OSError):
    """A file of more bytes than are read of one; the reason is a sentence about "it"."""


def open_plain(path: Path | str, *, follow: bool = True) -> BinaryIO:
    """A file, open for reading; neither waits nor touches what is no plain file.

    Raises NotPlain, IsADirectoryError, and other OSErrors, all with the file's name; ValueError for a name
    that no file can have. Without `follow`, a path that is a link is one that cannot be opened.
    """
    # Looked at before it is opened, because opening alone does something to some devices; and after, because
    # it may be another by then.
    _refuse_other(os.stat(path, follow_symlinks=follow), path)
    handle = os.open(path, os.O_RDONLY | _NO_WAIT | (0 if follow else _flags("O_NOFOLLOW")))
    try:
        _refuse_other(os.fstat(handle), path)
        return os.fdopen(handle, "rb")
    except BaseException:
        os.close(handle)
        raise


def read_plain(path: Path | str, largest: int, *, follow: bool = True) -> bytes:
    """All of a file of at most `largest` bytes. Raises TooLarge, and what `open_plain` raises."""
    with open_plain(path, follow=follow) as file:
        # Its size alone is not enough: the files of some systems are of size 0, and files grow.
        is_small = os.fstat(file.fileno()).st_size <= largest
        with naming(path):
            content = file.read(largest + 1) if is_small else b""
    if not is_small or len(content) > largest:
        raise TooLarge(errno.EFBIG, f"it is larger than {in_units(largest)}", str(path))
    return content


@contextmanager
def naming(path: Path | str) -> Iterator[None]:
    """Give errors of the disk that do not say which file they are about (those of `write`) its name."""
    try:
        yield
    except OSError as error:
        if error.filename is not None or error.errno is None:
            raise
        raise OSError(error.errno, error.strerror, str(path)) from error


def in_units(size: int) -> str:
    """A number of bytes for people: `8 MiB`, `64 KiB`."""
    for unit, name in ((1 << 20, "MiB"), (1 << 10, "KiB")):
        if size >= unit:
            return f"{size / unit:.3g} {name}"
    return plural(size, "byte")


def _refuse_other(status: os.stat_result, path: Path | str) -> None:
    kind = stat.S_IFMT(status.st_mode)
    if kind == stat.S_IFDIR:
        raise IsADirectoryError(errno.EISDIR, "it is a folder", str(path))
    if kind == stat.S_IFLNK:
        raise NotPlain(errno.ELOOP, "it is a link", str(path))
    if kind in _KINDS:
        raise NotPlain(errno.EINVAL, f"it is {_KINDS[kind]}, and only plain files are read", str(path))
