"""Run folders as `execute` leaves them, written here by hand: what they say is known."""

from __future__ import annotations

import hashlib
import json
from pathlib import Path
from typing import Any

import cv2
import numpy as np

from cleancli.recording.journal import (
    Acted,
    AreaEntry,
    Chance,
    Ended,
    Expected,
    FactEntry,
    Failed,
    Learned,
    Looked,
    Planned,
    Record,
    RuleEntry,
    Spent,
    Started,
    StepEntry,
    encode,
)

GONE = Chance(0.6, "change", (FactEntry("dirt", ("a1",), False),))
SMALLER = Chance(0.3, "change", (FactEntry("size", ("a1",), "small"), FactEntry("scattered", ("a1",), True)))
NOISE = Chance(0.1, "noise", ())
EXPECTED = Expected("fast_medium", (GONE, SMALLER, NOISE))
SECONDS = {
    "planning": 0.9,
    "perceiving": 0.8,
    "extra_perceptions": 2.25,
    "transits": 11.5,
    "actions": 21.0,
    "learning": 0.0,
}


def area(name: str) -> AreaEntry:
    return AreaEntry(name, (0.1, 0.0), (0.03, 0.02), 0.1, 0.0009)


def looked(clock: float, *names: str) -> Looked:
    facts = tuple(FactEntry("dirt", (name,), True) for name in names)
    return Looked(clock, 0.2, tuple(area(name) for name in names), dict.fromkeys(names, "area"), facts)


def plan(*calls: tuple[str, str]) -> Planned:
    steps = tuple(StepEntry(action, (name,), EXPECTED) for action, name in calls)
    return Planned("prada+", 0.3, 1.85, "sampled", 0.25, steps)


FAST, STRAIGHT = "moveToContainerFast", "moveToContainerStraight"
RECORDS: tuple[Record, ...] = (
    looked(0.0, "a1", "a2"),
    Spent({"perceiving": 0.2, "transits": 0.0}),
    plan((FAST, "a1"), (FAST, "a2")),
    Spent({"planning": 0.3}),
    Started(1, FAST, ("a1",), EXPECTED),
    looked(9.0, "a2"),
    Acted(1, FAST, ("a1",), 9.0, {"transits": 3.0, "actions": 6.0}, "fast_medium", 0, GONE.effects),
    Spent({"perceiving": 0.2, "transits": 3.0, "actions": 6.0}),
    Started(2, FAST, ("a2",), EXPECTED),
    Failed(2, FAST, ("a2",), 11.0, {"transits": 2.0}, "it can't reach <there> & back"),
    Spent({"transits": 2.0}),
    plan((STRAIGHT, "a2")),
    Spent({"planning": 0.6}),
    Started(3, STRAIGHT, ("a2",), EXPECTED),
    looked(34.0),
    Acted(3, STRAIGHT, ("a2",), 34.0, {"transits": 6.5, "actions": 15.0}, "fast_medium", None, ()),
    Spent({"transits": 6.5, "actions": 15.0, "perceiving": 0.4}),
    looked(34.75),
    Spent({"extra_perceptions": 2.25}),
    Ended(34.75, "no dirt is seen any more", True, 3, SECONDS),
)


def header(**changes: Any) -> dict[str, Any]:
    sha = hashlib.sha256(b"text").hexdigest()
    return {
        "format": 1,
        "versions": {"cleancli": "0.1.0", "numpy": "2.0"},
        "seed": 1,
        "options": {"planner": "prada+", "commit": 2},
        "files": [
            {"path": "domains/cleaning.nid", "sha256": sha, "copy": "files/cleaning.nid"},
            {"path": "problems/two_groups.nid", "sha256": sha, "copy": "files/two_groups.nid"},
        ],
        "episode": {
            "reason": "no dirt is seen any more",
            "clean": True,
            "actions": 3,
            "seconds": {**SECONDS, "total": sum(SECONDS.values())},
        },
        "truth": {"particles": 28, "in_container": 27, "on_table": 1, "in_dustpan": 0, "on_floor": 0},
        **changes,
    }


def write_run(folder: Path, records: tuple[Record, ...] = RECORDS, pictures: int = 4, **changes: Any) -> Path:
    """A run folder with so many pictures."""
    folder.mkdir(parents=True)
    (folder / "run.json").write_text(json.dumps(header(**changes)), encoding="utf-8")
    (folder / "journal.jsonl").write_text(
        "".join(encode(record) + "\n" for record in records), encoding="utf-8"
    )
    rng = np.random.default_rng(0)
    for number in range(pictures):
        picture = cv2.resize(rng.integers(0, 255, (5, 12, 3), np.uint8), (1280, 508))
        cv2.imwrite(str(folder / f"step-{number:03d}.png"), picture)
    return folder


LAMPS = """domain lamps {
  types      { lamp }
  predicates { lit(?l - lamp) hot(?l - lamp) }
  derived    { burning := count ?l - lamp: lit(?l) }
  actions    { press(?l - lamp) turn(?l - lamp) }
  rule pressed: press(?l) { when lit(?l) then 0.9: not lit(?l)  0.1: nothing }
  rule turned: turn(?l) { when lit(?l) then 0.5 [prior 0.7, seen 8]: not lit(?l)  rest [seen 8]: hot(?l) }
  reward { decrease(burning) }
}
"""


def believed(rule: str | None, first: float, seen: tuple[float, float], width: float = 0.1) -> Learned:
    """What is believed of a rule with two outcomes, so far to both sides."""
    low, high = round(first - width, 4), round(first + width, 4)
    intervals = ((low, high), (round(1 - high, 4), round(1 - low, 4)))
    return Learned((RuleEntry(rule, (first, 1 - first), seen, intervals),))


PRESSED = RECORDS[4:8]
"""An action that was begun and is over, with what it took."""

LESSONS: tuple[tuple[Record, ...], ...] = (
    (*PRESSED, believed("pressed", 0.8, (1, 1), 0.2), *PRESSED, believed("pressed", 0.7, (2, 1), 0.3)),
    (believed("pressed", 0.7, (2, 1), 0.3), *PRESSED, *PRESSED, believed("pressed", 0.6, (3, 2), 0.2)),
    (*PRESSED, believed("turned", 0.4, (8, 9))),
)
"""The journals of three episodes, of two actions each but for the last one."""


def write_series(
    folder: Path, domain: str = LAMPS, known: int = 3, episodes: int = 3, **changes: Any
) -> Path:
    """The folder of a series of which three episodes have begun."""
    source = domain.encode()
    sha256, unlike = hashlib.sha256(source).hexdigest(), hashlib.sha256(b"text").hexdigest()
    files = [
        {"path": "lamps.nid", "sha256": sha256, "copy": "files/lamps.nid"},
        {"path": "evening.nid", "sha256": unlike, "copy": "files/evening.nid"},
    ]
    for number, records in enumerate(LESSONS):
        actions = sum(isinstance(record, Acted) for record in records)
        seconds = {"planning": 1.0, "actions": 10.0 * actions, "learning": 2.0 * (3 - number)}
        episode = {
            "reason": "nothing is left to do",
            "clean": True,
            "actions": actions,
            "seconds": {**seconds, "total": sum(seconds.values())},
        }
        changed = {
            "seed": 4 + number,
            "files": files,
            "options": {"known": known},
            "episode": episode,
            **changes,
        }
        run = write_run(folder / f"evening-seed{4 + number}-001", records, 0, **changed)
        (run / "files").mkdir()
        (run / "files" / "lamps.nid").write_bytes(source)
    told = {"format": 1, "episodes": episodes, "seed": 4, "video": False, "writes": True, "called": "runs/it"}
    (folder / "series.json").write_text(json.dumps(told), encoding="utf-8")
    return folder
