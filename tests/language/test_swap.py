"""Files that are written while others write them, or while the writer dies: at every line of the code that
does.

Nothing here says what that code does when. An intruder, or death, comes at its first line, at its second, and
so on to the last; what must be true afterwards is the same each time.
"""

from __future__ import annotations

import errno
import itertools
import os
import signal
import stat
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import suppress
from pathlib import Path
from types import FrameType

import pytest

from cleancli.files import exchange as swap
from cleancli.files import lease
from cleancli.files.replace import Replacement, replace_file, write_all, write_atomically
from cleancli.language.diagnostics.refused import Refused

TRACED = {lease.__file__, swap.__file__}
OLD, NEW, THEIRS = "old text", "new text that is longer", "theirs"


@pytest.fixture(autouse=True)
def no_waiting_for_the_disk(monkeypatch: pytest.MonkeyPatch) -> None:
    """What is on the disk after a power failure is not looked at here."""
    monkeypatch.setattr(os, "fsync", lambda handle: None)


def at_line(number: int, happens: Callable[[], None], work: Callable[[], None]) -> bool:
    """Let something happen before the n-th line of the writing code runs; says whether it came to that
    line."""
    count, happened = itertools.count(), []

    def trace(frame: FrameType, event: str, _: object) -> object:
        if frame.f_code.co_filename not in TRACED:
            return None
        if event == "line" and next(count) == number:
            happened.append(number)
            happens()
        return trace

    before = sys.gettrace()
    sys.settrace(trace)  # type: ignore[arg-type]
    try:
        work()
    finally:
        sys.settrace(before)
    return bool(happened)


def moments(happens: Callable[[], None], work: Callable[[], None]) -> Iterator[int]:
    """The lines before which it happened, each in a run of its own; ends after the last."""
    for number in itertools.count():
        if not at_line(number, happens, work):
            return
        yield number


def quietly(*changes: Replacement) -> list[str]:
    """Write, and return the codes of what was refused."""
    try:
        write_all(changes)
    except Refused as refused:
        return [found.code for found in refused.diagnostics]
    return []


def replaced(path: Path, text: str) -> None:
    """What most editors do: write a new file beside the old one, and rename it."""
    beside = path.with_name("editor's own")
    beside.write_text(text)
    beside.replace(path)


EDITORS = """
import sys
for line in sys.stdin:
    with open(line.rstrip(), "w") as file:
        file.write("theirs")
    print("saved", flush=True)
"""


@pytest.fixture
def in_place() -> Iterator[tuple[Callable[[Path], None], Callable[[], bool]]]:
    """What other editors do: another process writes into the file itself; and whether it could, in the end.
    It is waited for, but not for long: it may be kept waiting itself."""
    with subprocess.Popen(
        [sys.executable, "-c", EDITORS], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    ) as process:
        assert process.stdin is not None
        assert process.stdout is not None
        saved = threading.Semaphore(0)
        lines = process.stdout

        def count() -> None:
            for _ in lines:
                saved.release()

        threading.Thread(target=count, daemon=True).start()

        def save(path: Path) -> None:
            process.stdin.write(f"{path}\n")  # type: ignore[union-attr]
            process.stdin.flush()  # type: ignore[union-attr]
            if saved.acquire(timeout=0.02):
                saved.release()

        def is_done() -> bool:
            return saved.acquire(timeout=10)

        yield save, is_done
        process.stdin.close()


def only(folder: Path, *names: str) -> bool:
    """Whether the folder holds these files and no others."""
    return sorted(os.listdir(folder)) == sorted(names)


def test_who_replaces_the_file_meanwhile_keeps_what_he_wrote(tmp_path: Path) -> None:
    path = tmp_path / "a.nid"
    refused = 0

    def work() -> None:
        nonlocal refused
        path.write_text(OLD)
        refused += quietly(Replacement(path, NEW, OLD)) == ["E006"]

    for number in moments(lambda: replaced(path, THEIRS), work):
        assert path.read_text() == THEIRS, f"at line {number}"
        assert only(tmp_path, "a.nid"), f"at line {number}"
    assert number > 60
    assert 40 < refused < number
    assert path.read_text() == NEW, "nobody came in the last run"


def test_who_writes_into_the_file_meanwhile_keeps_what_he_wrote(
    tmp_path: Path, in_place: tuple[Callable[[Path], None], Callable[[], bool]]
) -> None:
    path = tmp_path / "a.nid"
    save, is_done = in_place

    def work() -> None:
        path.write_text(OLD)
        quietly(Replacement(path, NEW, OLD))

    for number in moments(lambda: save(path), work):
        assert is_done(), f"at line {number}, the editor waits for ever"
        assert path.read_text() == THEIRS, f"at line {number}"
        assert only(tmp_path, "a.nid"), f"at line {number}"
    assert number > 60
    assert path.read_text() == NEW


def test_of_several_files_all_are_written_or_none_whoever_comes_when(tmp_path: Path) -> None:
    one, other, made = (tmp_path / name for name in ("one.nid", "other.nid", "made.nid"))
    codes: list[str] = []

    def work() -> None:
        one.write_text(OLD)
        other.write_text(OLD)
        made.unlink(missing_ok=True)
        codes[:] = quietly(
            Replacement(one, NEW, OLD), Replacement(made, NEW, None), Replacement(other, NEW, OLD)
        )

    for number in moments(lambda: replaced(other, THEIRS), work):
        assert other.read_text() == THEIRS
        expected = (OLD, False) if codes else (NEW, True)
        assert (one.read_text(), made.exists()) == expected, f"at line {number}"
        assert only(tmp_path, "one.nid", "other.nid", *["made.nid"] * (not codes))
    assert number > 100


def test_a_file_that_another_makes_meanwhile_is_his(tmp_path: Path) -> None:
    path = tmp_path / "a.nid"

    def work() -> None:
        path.unlink(missing_ok=True)
        quietly(Replacement(path, NEW, None))

    for number in moments(lambda: replaced(path, THEIRS), work):
        assert path.read_text() == THEIRS, f"at line {number}"
        assert only(tmp_path, "a.nid")
    assert number > 20


def test_a_newer_edit_goes_before_an_older_one(tmp_path: Path) -> None:
    """While the first intruder's file is put back, a second one comes."""
    path = tmp_path / "a.nid"
    saved: list[str] = []

    def save(text: str) -> None:
        saved.append(text)
        replaced(path, text)

    def work() -> None:
        path.write_text(OLD)
        saved.clear()
        with pytest.MonkeyPatch.context() as patched:
            exchange, calls = swap._renamed, itertools.count()

            def exchanged(name: Path, other: Path, how: int) -> bool:
                if next(calls) == 0:
                    save(THEIRS)
                return exchange(name, other, how)

            patched.setattr(swap, "_renamed", exchanged)
            quietly(Replacement(path, NEW, OLD))

    for number in moments(lambda: save("second"), work):
        assert path.read_text() == saved[-1], f"at line {number}"
        assert only(tmp_path, "a.nid")
    assert number > 60
    assert path.read_text() == THEIRS


@pytest.mark.parametrize("exchange", [True, False], ids=["exchange", "no exchange"])
def test_who_dies_anywhere_leaves_each_file_whole_and_nothing_that_the_next_does_not_remove(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, exchange: bool
) -> None:
    if not exchange:
        monkeypatch.setattr(swap, "_renameat2", None)
    one, made = tmp_path / "one.nid", tmp_path / "made.nid"
    left = 0

    def work() -> None:
        write_all([Replacement(one, NEW, OLD), Replacement(made, NEW, None)])

    for number in itertools.count():
        one.write_text(OLD)
        made.unlink(missing_ok=True)
        child = os.fork()
        if child == 0:
            at_line(number, lambda: os._exit(9), work)
            os._exit(0)
        ended = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
        assert one.read_text() in (OLD, NEW), f"at line {number}"
        assert not made.exists() or made.read_text() == NEW
        left += not only(tmp_path, "one.nid", *["made.nid"] * made.exists())
        replace_file(tmp_path / "next.nid", "")
        assert only(tmp_path, "one.nid", "next.nid", *["made.nid"] * made.exists()), f"at line {number}"
        if ended == 0:
            break
    assert number > 80
    assert left > 20, "some die with files beside theirs"


def test_nothing_is_removed_that_only_looks_like_a_leftover(tmp_path: Path) -> None:
    kept = [".hidden", ".a.nid.k3j4", ".cleancli", ".cleancli-notes.part", "cleancli-0123456789abcdef.part"]
    for name in kept:
        (tmp_path / name).write_text("mine")
    (tmp_path / ".cleancli-0123456789abcdee.part").symlink_to(".hidden")
    (tmp_path / ".cleancli-0123456789abcdef.part").mkdir()
    os.mkfifo(tmp_path / ".cleancli-0123456789abcded.part")
    # What another program has put at the name of a leftover is known by its number.
    (tmp_path / ".cleancli-1-2.part").write_text("another's")
    before = sorted(os.listdir(tmp_path))
    (tmp_path / ".cleancli-00000000000000ff.part").write_text("left over")
    replace_file(tmp_path / "a.nid", "")
    assert only(tmp_path, *before, "a.nid")


def test_what_a_living_process_has_beside_its_file_is_left_alone(tmp_path: Path) -> None:
    path, other = tmp_path / "a.nid", tmp_path / "other.nid"

    def work() -> None:
        path.write_text(OLD)
        write_atomically(path, NEW, OLD)

    for number in moments(lambda: replace_file(other, "x"), work):
        assert path.read_text() == NEW, f"at line {number}"
    assert number > 60


@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")  # files that the end closes
def test_a_signal_waits_until_files_have_changed_places(tmp_path: Path) -> None:
    one, other = tmp_path / "one.nid", tmp_path / "other.nid"
    signals = itertools.cycle([signal.SIGINT, signal.SIGTERM, signal.SIGHUP])

    class Ended(BaseException):
        pass

    def end(number: int, _: object) -> None:
        raise Ended

    def work() -> None:
        one.write_text(OLD)
        other.write_text(OLD)
        with suppress(Ended):
            write_all([Replacement(one, NEW, OLD), Replacement(other, NEW, OLD)])

    before = {number: signal.signal(number, end) for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)}
    try:
        for line in moments(lambda: signal.raise_signal(next(signals)), work):
            assert one.read_text() == other.read_text(), f"at line {line}"
            assert only(tmp_path, "one.nid", "other.nid"), f"at line {line}"
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
    assert line > 100


def test_two_processes_of_this_program_write_one_after_the_other(tmp_path: Path) -> None:
    """Each adds 1 to a number as often as it can; none that is not refused is lost."""
    path = tmp_path / "a.nid"
    path.write_text("0")
    script = (
        "import sys; from pathlib import Path; from cleancli.files.replace import write_atomically\n"
        "from cleancli.language.diagnostics.refused import Refused\n"
        "done = 0\n"
        "while done < 30:\n"
        "    text = Path(sys.argv[1]).read_text()\n"
        "    try:\n"
        "        write_atomically(sys.argv[1], str(int(text) + 1), text)\n"
        "        done += 1\n"
        "    except Refused:\n"
        "        pass\n"
    )
    processes = [subprocess.Popen([sys.executable, "-c", script, str(path)]) for _ in range(3)]
    assert [process.wait(60) for process in processes] == [0, 0, 0]
    assert path.read_text() == "90"
    assert only(tmp_path, "a.nid")


def test_files_are_locked_in_one_order_so_that_two_commands_never_wait_for_each_other(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    paths = [tmp_path / f"{name}.nid" for name in "abcdef"]
    for path in paths:
        path.touch()
    places = {path.stat().st_ino: path.name for path in paths}
    asked: list[str] = []
    take = lease.lock

    def noted(handle: int) -> bool | None:
        asked.append(places[os.fstat(handle).st_ino])
        return take(handle)

    monkeypatch.setattr(lease, "lock", noted)
    for order in (paths, paths[::-1], paths[3:] + paths[:3] + paths):
        asked.clear()
        with lease.locked(order):
            assert asked == [path.name for path in paths]


def test_a_file_that_is_held_for_long_is_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(lease, "PATIENCE", 0.1)
    path = tmp_path / "a.nid"
    path.write_text(OLD)
    with lease.locked([path]), pytest.raises(OSError, match="another process is writing it") as held:
        write_atomically(path, NEW, OLD)
    assert held.value.filename == str(path)
    with path.open("r+"), pytest.raises(Refused, match="is being written by another program"):
        write_atomically(path, NEW, OLD)
    assert path.read_text() == OLD
    assert only(tmp_path, "a.nid")


def test_what_the_file_is_like_stays(tmp_path: Path) -> None:
    if os.getuid() != 0:
        pytest.skip("only root gives files away")
    path = tmp_path / "a.nid"
    path.write_text(OLD)
    os.chown(path, 1234, 4321)
    path.chmod(0o2751)
    os.setxattr(path, "user.note", b"mine")
    write_atomically(path, NEW, OLD)
    status = path.stat()
    assert (status.st_uid, status.st_gid, stat.S_IMODE(status.st_mode)) == (1234, 4321, 0o2751)
    assert os.getxattr(path, "user.note") == b"mine"
    assert path.read_text() == NEW


def test_an_owner_who_could_not_stay_is_a_reason_to_write_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "a.nid"
    path.write_text(OLD)
    if os.getuid() == 0:
        os.chown(path, 1234, 4321)

    def forbidden(*_: object) -> None:
        raise PermissionError(errno.EPERM, "Operation not permitted")

    monkeypatch.setattr(os, "fchown", forbidden)
    monkeypatch.setattr(os, "fstat", _of_another(os.fstat))
    with pytest.raises(PermissionError, match="its owner and group would not stay") as refused:
        write_atomically(path, NEW, OLD)
    assert refused.value.filename == str(path)
    assert path.read_text() == OLD
    assert only(tmp_path, "a.nid")


def _of_another(real: Callable[[int], os.stat_result]) -> Callable[[int], os.stat_result]:
    """As if new files belonged to another user than old ones."""

    def changed(handle: int) -> os.stat_result:
        status = real(handle)
        fields = list(status)
        fields[5] += status.st_size == len(NEW)
        return os.stat_result(fields) if fields[5] != status.st_gid else status

    return changed


def test_a_file_with_several_names_is_refused_with_a_word(tmp_path: Path) -> None:
    path, name = tmp_path / "a.nid", tmp_path / "b.nid"
    path.write_text(OLD)
    os.link(path, name)
    with pytest.raises(OSError, match="several names") as refused:
        write_atomically(path, NEW, OLD)
    assert (refused.value.errno, refused.value.filename) == (errno.EMLINK, str(path))
    assert (path.read_text(), name.read_text()) == (OLD, OLD)


@pytest.mark.parametrize("missing", ["leases", "locks, too"])
def test_systems_without_leases_or_locks_write_all_the_same(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, missing: str
) -> None:
    if missing == "locks, too":
        monkeypatch.setattr(lease, "fcntl", None)
    else:
        monkeypatch.delattr("fcntl.F_SETLEASE", raising=False)
    path = tmp_path / "a.nid"
    path.write_text(OLD)
    write_atomically(path, NEW, OLD)
    assert path.read_text() == NEW
    with pytest.raises(Refused, match="changed"):
        write_atomically(path, THEIRS, OLD)


def test_names_are_made_durable_when_all_files_are_written(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """In each folder once, so that a power failure after the command has ended takes nothing back."""
    paths = [tmp_path / "a" / "one.nid", tmp_path / "b" / "two.nid", tmp_path / "a" / "three.nid"]
    for path in paths:
        path.parent.mkdir(exist_ok=True)
        path.write_text(OLD)
    synced: list[tuple[str, list[str]]] = []
    monkeypatch.setattr(
        swap, "sync_folder", lambda folder: synced.append((folder.name, [p.read_text() for p in paths]))
    )
    write_all([Replacement(path, NEW, OLD) for path in paths])
    assert synced == [("a", [NEW] * 3), ("b", [NEW] * 3)]


@pytest.mark.parametrize("number", [errno.ENOSPC, errno.EIO, errno.EROFS, errno.EACCES, errno.EDQUOT])
@pytest.mark.parametrize("where", ["open", "fsync", "fchmod", "rename"])
@pytest.mark.parametrize("named", ["", "a.nid", "beside"])
def test_every_error_of_the_disk_names_the_file_and_leaves_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, number: int, where: str, named: str
) -> None:
    """And the folder, where the file that is first written there is what could not be."""
    path = tmp_path / "a.nid"
    path.write_text(OLD)
    real = getattr(os, where)

    def fails(*arguments: object, **options: object) -> object:
        if where == "open" and str(arguments[0]) == str(path):
            return real(*arguments, **options)
        raise OSError(number, os.strerror(number), *([str(tmp_path / named)] if named else ()))

    with monkeypatch.context() as patched:
        patched.setattr(os, where, fails)
        with pytest.raises(OSError, match=os.strerror(number)) as raised:
            write_atomically(path, NEW, OLD)
    assert (raised.value.errno, raised.value.filename) == (number, str(path))
    missing = named == "beside" and number in (errno.EROFS, errno.EACCES)
    assert (f", in `{tmp_path}`, where the new file" in str(raised.value)) == missing
    assert path.read_text() == OLD
    assert only(tmp_path, "a.nid")


def test_files_of_the_program_itself_keep_their_mode_and_replace_only_files(tmp_path: Path) -> None:
    path = tmp_path / "run.json"
    replace_file(path, "1")
    path.chmod(0o640)
    replace_file(path, b"2")
    assert (path.read_text(), stat.S_IMODE(path.stat().st_mode)) == ("2", 0o640)
    os.mkfifo(tmp_path / "pipe")
    with pytest.raises(OSError, match="no plain file"):
        replace_file(tmp_path / "pipe", "3")
    assert only(tmp_path, "run.json", "pipe")


def test_a_write_is_quick(tmp_path: Path) -> None:
    path = tmp_path / "a.nid"
    path.write_text("0")
    started = time.perf_counter()
    for number in range(20):
        write_atomically(path, str(number + 1), str(number))
    assert time.perf_counter() - started < 4
