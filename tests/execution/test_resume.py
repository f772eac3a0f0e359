"""Runs that are cut short anywhere, and go on."""

from __future__ import annotations

import itertools
import json
import resource
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterable, Iterator
from fractions import Fraction
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from cleancli.api.run_session import alone_in, interruptions
from cleancli.cli.main import run
from cleancli.compiler.task import GroundAction
from cleancli.execution.episode_state import Account, EpisodeState, FailedAttempt, Move, Situation
from cleancli.geometry.ellipse import Ellipse
from cleancli.language.diagnostics.refused import Refused
from cleancli.language.model import Fact, Object
from cleancli.motion.path import Dustpan, Interpolation, ToolPath, Waypoint
from cleancli.perception.area import Area
from cleancli.recording import checkpoint, run_folder
from cleancli.recording.folder import APPENDED, checkpoints
from cleancli.recording.journal import Acted, Ended, Resumed, read_journal

WORDS = ["execute", "cleaning", "three_areas", "--seed", "5", "--samples", "50", "--quiet"]


class Killed(BaseException):
    """Stands for a process that is gone: nobody may catch it."""


def dying_after(events: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Let the recorder's process die after so many events, in the middle of writing a line."""
    write, count = run_folder.Recorder.write, itertools.count()

    def dies(self: run_folder.Recorder, event: object) -> None:
        if next(count) == events:
            self._journal.write('{"event":"look')
            self._journal.flush()
            raise Killed
        write(self, event)  # type: ignore[arg-type]

    monkeypatch.setattr(run_folder.Recorder, "write", dies)


def dying_at_sync(number: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Let the process die where it asks for the n-th time that something be on the disk."""
    count = itertools.count()

    def dies(handle: int) -> None:
        if next(count) == number:
            raise Killed

    monkeypatch.setattr("os.fsync", dies)


def deaths(
    dying: Callable[[int, pytest.MonkeyPatch], None], moments: Iterable[int], monkeypatch: pytest.MonkeyPatch
) -> Iterator[int]:
    """The moments at which a run died, each a run of its own; ends with the first that it outlives."""
    for moment in moments:
        shutil.rmtree("cut", ignore_errors=True)
        with monkeypatch.context() as patched:
            dying(moment, patched)
            try:
                run([*WORDS, "--runs", "cut"])
            except Killed:
                pass
            else:
                return
        yield moment


def cut_short(monkeypatch: pytest.MonkeyPatch) -> Path:
    """The folder of a run that died after 20 events."""
    with monkeypatch.context() as patched:
        dying_after(20, patched)
        with pytest.raises(Killed):
            run(WORDS)
    return Path("runs/three_areas-seed5-001")


@pytest.fixture(autouse=True)
def inside(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def actions(folder: Path) -> list[tuple[int, str]]:
    return [(r.number, r.action) for r in read_journal(folder).records if isinstance(r, Acted)]


def test_a_run_that_dies_anywhere_is_readable_and_goes_on_to_the_same_end(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    assert run([*WORDS, "--runs", "whole"]) == 0
    whole = Path("whole/three_areas-seed5-001")
    folder = Path("cut/three_areas-seed5-001")
    for events in deaths(dying_after, range(0, 40, 3), monkeypatch):
        assert "episode" not in json.loads((folder / "run.json").read_text())
        assert read_journal(folder).cut
        assert run(["execute", "--resume", str(folder), "--quiet"]) == 0
        journal = read_journal(folder)
        assert not journal.cut
        assert actions(folder) == actions(whole), f"cut after {events} events"
        assert sum(isinstance(each, Resumed) for each in journal.records) == 1
        ended = journal.records[-1]
        assert isinstance(ended, Ended)
        assert ended.clean
        spent = json.loads((folder / "run.json").read_text())["episode"]["seconds"]
        told = [json.loads(line) for line in (folder / "journal.jsonl").read_text().splitlines()]
        total = sum(sum(line["seconds"].values()) for line in told if line["event"] == "spent")
        assert total == pytest.approx(spent["total"])
        assert len((folder / "experience.jsonl").read_text().splitlines()) == len(actions(folder))
    assert events > 10


def test_a_run_that_dies_at_any_write_goes_on_to_the_same_end(monkeypatch: pytest.MonkeyPatch) -> None:
    assert run([*WORDS, "--runs", "whole"]) == 0
    whole, folder = Path("whole/three_areas-seed5-001"), Path("cut/three_areas-seed5-001")
    for number in deaths(dying_at_sync, itertools.count(), monkeypatch):
        if (folder / "run.json").exists():
            ended = json.loads((folder / "run.json").read_text()).get("episode") is not None
            assert run(["execute", "--resume", str(folder), "--quiet"]) == (2 if ended else 0)
            assert actions(folder) == actions(whole), f"cut at write {number}"
            assert ended or not [p for p in folder.rglob(".*") if p.is_file()]
    assert number > 10


def test_two_processes_do_not_go_on_with_one_run(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = cut_short(monkeypatch)
    with alone_in(folder):
        assert run(["execute", "--resume", str(folder)]) == 2
    assert "another process works on" in capsys.readouterr().err
    assert run(["execute", "--resume", str(folder), "--quiet"]) == 0


def test_a_system_without_locks_keeps_nobody_out(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setitem(sys.modules, "fcntl", None)
    inside = 0
    with alone_in(tmp_path), alone_in(tmp_path):
        inside += 1
    assert inside == 1


def test_ctrl_c_is_kept_until_the_loop_looks_and_works_at_once_the_third_time() -> None:
    def press(times: int) -> int:
        with interruptions() as pressed:
            for _ in range(times):
                signal.raise_signal(signal.SIGINT)
            return len(pressed)

    assert press(2) == 2
    with pytest.raises(KeyboardInterrupt):
        press(3)


@pytest.mark.needs_pybullet
def test_a_table_goes_on_after_a_kill(tmp_path: Path) -> None:
    words = ["execute", "cleaning", "two_groups", "--seed", "1", "--no-video", "--quiet"]
    process = subprocess.Popen([sys.executable, "-m", "cleancli.cli.main", *words])
    folder = tmp_path / "runs" / "two_groups-seed1-001"
    deadline = time.monotonic() + 120
    while not (folder / "state" / "001.npz").exists() and time.monotonic() < deadline:
        time.sleep(0.05)
    process.send_signal(signal.SIGKILL)
    process.wait()
    assert run(["execute", "--resume", str(folder), "--quiet"]) == 0
    numbers = [number for number, _ in actions(folder)]
    assert numbers == list(range(1, len(numbers) + 1))
    assert json.loads((folder / "run.json").read_text())["truth"]["on_table"] == 0


@pytest.mark.needs_pybullet
def test_ctrl_c_stops_with_the_tool_up_and_says_how_to_go_on(capsys: pytest.CaptureFixture[str]) -> None:
    words = ["cleancli.cli.main", "execute", "cleaning", "two_groups", "--seed", "1", "--no-video"]
    with subprocess.Popen([sys.executable, "-m", *words], stderr=subprocess.PIPE, text=True) as process:
        assert process.stderr is not None
        for line in process.stderr:
            if "decided" in line:
                break
        process.send_signal(signal.SIGINT)
        rest = process.stderr.read()
    assert process.returncode == 130
    assert "stopped with the tool up" in rest
    assert "--resume runs/two_groups-seed1-001" in rest
    assert (Path("runs/two_groups-seed1-001") / "journal.jsonl").read_text().endswith("}\n")


def test_a_run_does_not_begin_where_it_has_no_room(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("shutil.disk_usage", lambda _: SimpleNamespace(free=3 << 20))
    assert run(WORDS) == 5
    assert "a run needs up to 64 MB here, and 3 MB are free" in capsys.readouterr().err
    assert not list(Path("runs").iterdir())


def test_a_folder_that_cannot_be_made_ends_a_run_before_it_begins(capsys: pytest.CaptureFixture[str]) -> None:
    Path("file").write_text("")
    assert run([*WORDS, "--runs", "file/runs"]) == 5
    assert "file" in capsys.readouterr().err


def _little_disk() -> None:
    """Writing a file beyond 5 kB fails from now on, as on a disk that is full."""
    signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (5_000, 5_000))


def test_a_disk_that_fills_up_ends_a_run_with_an_error_and_it_can_go_on() -> None:
    assert run(["init", "wiping"]) == 0
    texts = ["wiping/wiping.nid", "wiping/two_stains.nid"]
    # Once with room on the disk: else the planner's compiled code is the first file that does not fit.
    assert run(["execute", *texts, "--runs", "room", "--quiet"]) == 0
    words = ["execute", *texts, "--runs", "full", "--quiet"]
    command = [sys.executable, "-m", "cleancli.cli.main", *words]
    ended = subprocess.run(command, preexec_fn=_little_disk, capture_output=True, text=True)
    assert (ended.returncode, "Traceback" in ended.stderr) == (5, False), ended.stderr
    assert "File too large" in ended.stderr
    assert "--resume full/two_stains-seed1-001" in ended.stderr
    folder = Path("full/two_stains-seed1-001")
    assert len(actions(folder)) > 1
    assert run(["execute", "--resume", str(folder), "--quiet"]) == 0


@pytest.mark.parametrize(
    ("words", "code", "says"),
    [
        (["--resume", "runs/whole"], 2, "has ended: nothing is left to do"),
        (["--resume", "runs"], 1, "E705"),
        (["--resume", "nowhere"], 2, "does not exist"),
        (["cleaning", "--resume", "runs/whole"], 2, "takes no DOMAIN"),
        (["--resume", "runs/whole", "--seed", "3"], 2, "takes no --seed"),
        (["--resume", "runs/whole", "--dry-run", "stroke.png"], 2, "takes no --dry-run"),
        ([], 2, "name a domain and a problem"),
    ],
)
def test_what_cannot_go_on_is_told(
    words: list[str], code: int, says: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(WORDS) == 0
    Path("runs/three_areas-seed5-001").rename("runs/whole")
    assert run(["execute", *words]) == code
    assert says in capsys.readouterr().err


def test_other_texts_and_broken_checkpoints_are_told(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = cut_short(monkeypatch)
    copy = folder / "files" / "three_areas.nid"
    text = copy.read_text()
    copy.write_text(text + "# another\n")
    assert run(["execute", "--resume", str(folder)]) == 1
    assert "is not the text any more" in capsys.readouterr().err
    copy.write_text(text)
    newest = max((folder / "state").glob("*.npz"))
    newest.write_bytes(b"nothing")
    assert run(["execute", "--resume", str(folder), "--quiet"]) == 0
    said = capsys.readouterr().err
    assert f"{newest}` is no checkpoint to go on from" in said
    assert "going on from the one before" in said
    assert not list(folder.glob(".*"))


def test_a_checkpoint_holds_everything(tmp_path: Path) -> None:
    area = Area(Ellipse((0.1, -0.2), (0.03, 0.01), 0.5), 1e-4, "a1")
    facts = frozenset({Fact("dirt", ("a1",)), Fact("size", ("a1",), "big"), Fact("left", ("a1",), 3)})
    point = Waypoint(1.0, 2.0, 3.0, 4.0, 5.0)
    path = ToolPath((point,), Interpolation.JOINT, Dustpan(point, point, 0.1))
    state = EpisodeState(
        situation=Situation((area,), (Object("a1", "area"),), facts, frozenset({"a1"}), 0.1),
        looks=3,
        named=4,
        actions=2,
        clear_looks=1,
        queue=(Move("sweep", ("a1",), path), Move("join2", ("a1", "a2"))),
        rest=(GroundAction("join2", ("a1", "a2"), 7.5, Fraction(1, 3)), GroundAction("push", (), None)),
        vain=(FailedAttempt(("push", ("a1",)), (area,), facts, 4, "out of reach", 0.3),),
        examples=((0, Fraction(31, 10)),),
        spent=Account(planning=0.25, actions=3.5),
        loading=1.0,
    )
    for name in APPENDED:
        (tmp_path / name).write_text("one\n")
    checkpoint.save(tmp_path, state, {"places": np.eye(3), "clock": np.array(1.5)})
    (written,) = checkpoints(tmp_path)
    saved = checkpoint.read(tmp_path, written)
    assert saved.episode == state
    assert saved.sizes == {"journal.jsonl": 4, "experience.jsonl": 4}
    np.testing.assert_array_equal(saved.world["places"], np.eye(3))


def test_an_episode_begins_with_nothing_seen_named_done_or_spent() -> None:
    begun = EpisodeState()
    assert (begun.looks, begun.named, begun.actions, begun.clear_looks) == (0, 0, 0, 0)
    assert (begun.situation, begun.queue, begun.rest, begun.vain, begun.examples) == (None, (), (), (), ())
    assert (begun.spent.total, begun.loading, begun.reason) == (0.0, 0.0, "")


def test_what_has_no_form_in_a_checkpoint_is_refused(tmp_path: Path) -> None:
    for name in APPENDED:
        (tmp_path / name).write_text("")
    with pytest.raises(NotImplementedError, match="object has no form"):
        checkpoint.save(tmp_path, EpisodeState(examples=object()), {})  # type: ignore[arg-type]
    assert not checkpoints(tmp_path)
    (tmp_path / "state").mkdir(exist_ok=True)
    damaged = tmp_path / "state" / "001.npz"
    damaged.write_bytes(b"")
    with pytest.raises(Refused, match="E706"):
        checkpoint.read(tmp_path, damaged)
