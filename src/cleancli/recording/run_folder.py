"""The run folder: what happened, whole and readable, whenever the run stops.

`run.json` is replaced atomically at the start and the end, `journal.jsonl` and `experience.jsonl` grow by
flushed lines, and each action leaves a picture and a checkpoint. All of it is opened before anything moves,
so that a folder which cannot be written is met early.
"""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Mapping
from contextlib import nullcontext, suppress
from pathlib import Path
from types import TracebackType
from typing import IO, Self

from cleancli.array_types import Image
from cleancli.execution.episode_state import Account, EpisodeState, World
from cleancli.execution.events import (
    Acted,
    Checkpoint,
    Decided,
    Ended,
    Event,
    Failed,
    Learned,
    Leaving,
    Looked,
    Moved,
    Started,
    StrokeEnded,
)
from cleancli.files.replace import replace_file
from cleancli.learning.experience import encode
from cleancli.recording import checkpoint, journal
from cleancli.recording.folder import EXPERIENCE, JOURNAL, RUN
from cleancli.recording.journal_writer import Entries
from cleancli.recording.pictures import step_picture, write_png
from cleancli.recording.video import Video

VIDEO_SIZE = (960, 720)
STEP_SIZE = (640, 480)
"""Width and height of the room in the video, and in the pictures of steps where there is no video: the first
picture of a size takes as long as many later ones."""

LEAST_SHOWN = 0.05
"""Seconds of a kind below which a video does not tell it."""


def write_run(folder: Path, fields: Mapping[str, object]) -> None:
    """Write what went into a run, and what came out as far as that is known."""
    replace_file(folder / RUN, json.dumps(dict(fields), indent=2, ensure_ascii=False) + "\n")


def _free_video(folder: Path) -> Path:
    """`video.mp4`, or, of a run that goes on, the next number: a video cannot be appended to."""
    names = (f"video{'' if number == 1 else f'-{number}'}.mp4" for number in range(1, 1_000_000))
    return next(folder / name for name in names if not (folder / name).exists())


def _totals(event: Ended) -> dict[str, object]:
    return {
        "reason": event.reason,
        "clean": event.clean,
        "actions": event.actions,
        "seconds": {**event.spent.by_kind(), "total": event.spent.total},
        "robot_clock": event.clock,
        "loading": event.loading,
    }


class Recorder:
    """Writes a run's events into its folder; `snapshot` makes a picture of the room, of some width
    and height, for people to look at; a world without a room has none. `save` gives the world at a
    checkpoint. A run that was cut short is `resumed`."""

    def __init__(
        self,
        folder: Path,
        header: Mapping[str, object],
        snapshot: Callable[[int, int], Image] | None,
        video: bool,
        entries: Entries,
        save: Callable[[], World],
        resumed: journal.Resumed | None = None,
    ) -> None:
        self._folder, self._header, self._snapshot = folder, dict(header), snapshot
        self._save, self._saved, self._resumed = save, -1, resumed is not None
        self._totals: dict[str, object] = {}
        self._last: Looked | None = None
        self._before: Looked | None = None
        self._started: Started | None = None
        self._room: Image | None = None
        self._spent, self._told, self._clock = Account(), 0.0, 0.0
        self._write_run()
        self._experience: IO[str] = (folder / EXPERIENCE).open("a", encoding="utf-8")
        self._journal: IO[str] = (folder / JOURNAL).open("a", encoding="utf-8")
        self._entries = entries
        self._video = Video(_free_video(folder)) if video and snapshot is not None else None
        if resumed is not None:
            self.note(resumed)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        files = (self._experience, self._journal, self._video)
        for file in files:
            # What cannot be written any more has been told already, or else is told now.
            with suppress(OSError) if error is not None else nullcontext():
                if file is not None:
                    file.close()

    def write(self, event: Event) -> None:
        """Record one event."""
        for record in self._entries.of(event):
            self.note(record)
        match event:
            case Looked():
                self._looked(event)
            case Started():
                self._started, self._before = event, self._last
            case Moved(clock):
                self._film(clock)
                self._clock = clock
            case StrokeEnded() | Failed():
                self._room = self._photographed()
            case Acted():
                self._acted(event)
            case Ended():
                self._totals["episode"] = _totals(event)
            case Checkpoint(state):
                self._checkpoint(state)
                self._spent, self._told = state.spent, self._clock
            case Decided() | Learned() | Leaving():
                pass

    def note(self, record: journal.Record) -> None:
        """Append a line to the journal."""
        self._journal.write(journal.encode(record) + "\n")
        self._journal.flush()

    def finish(self, truth: Mapping[str, object]) -> None:
        """Write the totals, with where the lentils truly are, apart from what perception believed."""
        self._totals["truth"] = dict(truth)
        self._write_run()

    def _looked(self, event: Looked) -> None:
        if self._last is None and not self._resumed:
            self._room = self._photographed()
            self._picture(0, event)
        self._last = event

    def _film(self, clock: float) -> None:
        """Add the room as it is now to the video, where one is made and the next picture is due."""
        if self._video is not None and self._snapshot is not None and self._video.wants(clock):
            self._video.add(self._snapshot(*VIDEO_SIZE), clock, self._caption(), self._account(clock))

    def _acted(self, event: Acted) -> None:
        if event.transition is not None and event.seen:
            lasted = {"transit": round(event.transit, 3), "seconds": round(event.seconds, 3)}
            # The seed tells runs apart in which the same has happened: what is given twice counts once.
            if event.transition.expected is not None:
                lasted["expected"] = event.transition.expected / 1000
            extra = {"seed": self._header["seed"], "number": event.number, **lasted}
            self._experience.write(encode(event.transition, extra) + "\n")
            self._experience.flush()
        assert self._before is not None, "an episode looks before it acts"
        self._picture(event.number, self._before)
        self._started = None

    def _checkpoint(self, state: EpisodeState) -> None:
        """Once for each number of actions: what was appended before is on the disk first."""
        if state.actions == self._saved:
            return
        for file in (self._journal, self._experience):
            os.fsync(file.fileno())
        checkpoint.save(self._folder, state, self._save())
        self._saved = state.actions

    def _photographed(self) -> Image | None:
        size = STEP_SIZE if self._video is None else VIDEO_SIZE
        return None if self._snapshot is None else self._snapshot(*size)

    def _picture(self, number: int, before: Looked) -> None:
        if before.frame is not None:
            picture = step_picture(before.frame, before.situation, self._started, self._room)
            write_png(self._folder / f"step-{number:03d}.png", picture)

    def _caption(self) -> str:
        return "looking" if self._started is None else f"{self._started.number}. {self._started.move}"

    def _account(self, clock: float) -> str:
        """What time was spent on before the motion under way, and how long that has lasted."""
        spent = {kind: seconds for kind, seconds in self._spent.by_kind().items() if seconds >= LEAST_SHOWN}
        told = {**spent, "under way": clock - self._told}
        return "   ".join(f"{kind.replace('_', ' ')} {seconds:.1f} s" for kind, seconds in told.items())

    def _write_run(self) -> None:
        write_run(self._folder, {**self._header, **self._totals})
