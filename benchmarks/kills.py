"""Nothing is torn, left over or overwritten: `python benchmarks/kills.py [--kills N] [--races N] [--seed N]`.

Kills: `fmt`, `learn --write`, `rename --write`, `convert`, `execute`, and a series of `execute --learn
--write` (both in the symbolic world) are ended at a moment drawn evenly over the time that they take, by
KILL, TERM, INT and HUP in turn, each in a process of its own; who ends before does not count. Then every file
must hold its old or its new content, whole; files that are written together must be all old or all new, but
where KILL came (how often it parted them is told); nothing may lie beside them, but where KILL came, and the
next command that writes there must remove that. A run must go on to the end and the actions that it would
have had, and a series to the text that it would have learned, byte for byte.

Races: while a command works, an editor saves a file that it writes, in place or by renaming, once or many
times. What was saved last must be in the file afterwards.

A process that has loaded everything is forked for each command. Exits with 1 if anything is lost. About 25
minutes with both cores otherwise idle; `--kills 4 --races 4` takes half a minute.
"""

from __future__ import annotations

import argparse
import itertools
import os
import random
import shutil
import signal
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from cleancli.cli.commands import convert as convert_command
from cleancli.cli.main import main as cleancli
from cleancli.conversion.convert import Converted, convert
from cleancli.recording.folder import JOURNAL
from cleancli.recording.journal import Acted, Ended, read_journal

ROOT = Path(__file__).resolve().parents[1]
SIGNALS = (signal.SIGKILL, signal.SIGTERM, signal.SIGINT, signal.SIGHUP)
UNTIDY = 4
"""Files that `fmt` lays out in one go."""

Files = dict[str, bytes]


@dataclass(slots=True)
class Case:
    """A command that writes: its line, which files it finds, and, once it has run, which it leaves.

    `together`: all of them change or none. `edited`: the file that an editor saves.
    """

    name: str
    line: str
    before: Files
    together: bool
    edited: str
    after: Files = field(default_factory=dict)
    seconds: float = 0.0

    @property
    def words(self) -> list[str]:
        return self.line.split()


def cases() -> dict[str, Case]:
    """The writers of texts."""
    starter = ROOT / "src" / "cleancli" / "cli" / "commands" / "starter"
    domain, problem = ((starter / name).read_bytes() for name in ("wiping.nid", "two_stains.nid"))
    golden = ROOT / "tests" / "golden"
    learned = {name: (golden / name).read_bytes() for name in ("domain.nid", "experience.jsonl")}
    kitchen = sorted((ROOT / "tests" / "conversion" / "kitchen").glob("*.dat"))
    library = {f"kitchen/{path.name}": path.read_bytes() for path in kitchen}
    made = {f"out/{name}.nid": b"# to be replaced\n" for name in ("domain", "problem")}
    untidy = {f"u{n}.nid": problem.replace(b"  ", b"\t") for n in range(UNTIDY)}
    both = {"wiping.nid": domain, "one.nid": problem, "two.nid": problem}
    found = (
        Case("fmt", "fmt .", untidy, False, "u0.nid"),
        Case("learn", "learn domain.nid experience.jsonl --write", learned, True, "domain.nid"),
        Case(
            "rename", "rename stain blot --domain wiping.nid one.nid two.nid --write", both, True, "one.nid"
        ),
        Case("convert", "convert kitchen --out out --force", library | made, True, "out/domain.nid"),
    )
    return {case.name: case for case in found}


# ---- processes


def started(words: list[str], folder: Path, begun: Callable[[], None] | None = None) -> int:
    """A process of its own for a command; `begun` is called there once `convert` has read its files."""
    child = os.fork()
    if child:
        return child
    try:
        os.chdir(folder)
        nowhere = os.open(os.devnull, os.O_RDWR)
        for number in range(3):
            os.dup2(nowhere, number)
        if begun is not None:

            def told(*arguments: Any) -> Converted:
                begun()
                return convert(*arguments)

            convert_command.convert = told  # type: ignore[attr-defined]
        cleancli(words)
    except SystemExit as ended:
        os._exit(int(ended.code or 0))
    finally:
        os._exit(99)


def ended(child: int) -> int:
    """The exit code of a process, below 0 for the signal that it died of."""
    return os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])


def put(files: Files, folder: Path) -> None:
    """Write the files into a folder that holds nothing else."""
    shutil.rmtree(folder, ignore_errors=True)
    for name, content in files.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_bytes(content)


def held(folder: Path) -> Files:
    """All files of a folder, by their path in it."""
    return {str(path.relative_to(folder)): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


def rehearsed(case: Case, folder: Path) -> None:
    """Let a command run to its end, which says what it leaves and how long it takes."""
    seconds = []
    for _ in range(3):
        put(case.before, folder)
        begun = time.perf_counter()
        code = ended(started(case.words, folder))
        seconds.append(time.perf_counter() - begun)
        assert code in (0, 1), f"{case.name} ends with {code} when nobody disturbs it"
    case.after, case.seconds = held(folder), max(seconds)
    assert case.after != case.before, f"{case.name} changes nothing"


def killed(words: list[str], seconds: float, number: int, folder: Path) -> int | None:
    """How a command ended that got a signal after so many seconds; None if it had ended before."""
    child = started(words, folder)
    time.sleep(seconds)
    if os.waitpid(child, os.WNOHANG)[0]:
        return None
    os.kill(child, number)
    return ended(child)


# ---- kills of what writes texts


def harm(case: Case, folder: Path, by_kill: bool) -> str:
    """What is wrong with the files after a kill."""
    now = held(folder)
    beside = [name for name in now if name not in case.after]
    if not all(Path(name).name.startswith(".cleancli-") for name in beside) or (beside and not by_kill):
        return f"left over: {beside}"
    changed = [name for name in case.after if case.after[name] != case.before[name]]
    for name in case.after:
        if now.get(name) not in (case.before[name], case.after[name]):
            return f"torn: {name}"
    new = sum(now[name] == case.after[name] for name in changed)
    return "parted" if case.together and new not in (0, len(changed)) else ""


def kills(case: Case, number: int, rng: random.Random, folder: Path) -> Iterator[tuple[str, str]]:
    """The name of the signal and what went wrong, for each of so many kills."""
    signals = itertools.cycle(SIGNALS)
    which, done = next(signals), 0
    while done < number:
        put(case.before, folder)
        if killed(case.words, rng.uniform(0, case.seconds), which, folder) is None:
            continue
        by_kill = which is signal.SIGKILL
        wrong = harm(case, folder, by_kill)
        left = any(name not in case.after for name in held(folder))
        following = (folder / case.edited).with_name("next.nid")
        following.write_bytes(b"domain  next { }")
        assert ended(started(["fmt", str(following)], folder)) == 0
        following.unlink()
        if not wrong and any(name not in case.after for name in held(folder)):
            wrong = f"the next command leaves {sorted(held(folder))}"
        yield which.name, ("left" if left and not wrong else wrong)
        done, which = done + 1, next(signals)


# ---- kills of runs


def run_kills(number: int, rng: random.Random, folder: Path) -> Iterator[tuple[str, str]]:
    """The same for `execute` in the symbolic world."""
    words = ["execute", "cleaning", "three_areas", "--seed", "5", "--samples", "50", "--quiet"]
    where = folder / "runs" / "three_areas-seed5-001"
    put({}, folder)
    folder.mkdir()
    begun = time.perf_counter()
    assert ended(started(words, folder)) == 0
    seconds, whole = time.perf_counter() - begun, actions(where)
    signals = itertools.cycle(SIGNALS)
    which, done = next(signals), 0
    while done < number:
        shutil.rmtree(folder / "runs", ignore_errors=True)
        code = killed(words, rng.uniform(0, seconds), which, folder)
        if hidden := [path.name for path in folder.glob("runs/.*")]:
            assert ended(started(words, folder)) == 0
            stay = [path.name for path in folder.glob("runs/.*")]
            if which is not signal.SIGKILL or stay:
                yield which.name, f"left over: {hidden}"
            continue
        if code is None or not where.exists():
            continue
        yield which.name, run_harm(where, folder, whole)
        done, which = done + 1, next(signals)


def actions(folder: Path) -> list[str]:
    return [record.action for record in read_journal(folder).records if isinstance(record, Acted)]


def run_harm(where: Path, folder: Path, whole: list[str]) -> str:
    """What is wrong with a run after a kill, and after it has gone on."""
    if not (where / "run.json").exists():
        return "it has a name, and no run.json"
    code = ended(started(["execute", "--resume", str(where), "--quiet"], folder))
    if code not in (0, 2):  # 2: it had ended
        return f"--resume ends with {code}"
    if hidden := [path.name for path in where.rglob(".*")]:
        return f"left over: {hidden}"
    journal = read_journal(where)
    if not journal.records or not any(isinstance(record, Ended) for record in journal.records):
        return f"{where / JOURNAL} has no end"
    return "" if actions(where) == whole else "it went on to another end"


# ---- kills of series

DOORS = """domain doors {
  types { door }
  predicates { open(?d - door) }
  derived { shut := count ?d - door: not open(?d) }
  actions { push(?d - door) [duration = 1 s] }
  rule pushed: push(?d) { when not open(?d) then CHANCE: open(?d) rest: nothing }
  reward { decrease(shut) }
}
"""
SERIES: Files = {
    "own.nid": DOORS.replace("CHANCE", "0.8").encode(),
    "true.nid": DOORS.replace("CHANCE", "0.3").encode(),
    "p.nid": b"problem p { domain = doors objects { a b - door } init { } }",
}
LEARNING = "execute own.nid p.nid --world true.nid --learn --write --episodes 4 --samples 20 --quiet"


def series_kills(number: int, rng: random.Random, folder: Path) -> Iterator[tuple[str, str]]:
    """The same for a series that writes what it has learned after each episode."""
    words = LEARNING.split()
    put(SERIES, folder)
    begun = time.perf_counter()
    assert ended(started(words, folder)) in (0, 3)
    seconds, whole = time.perf_counter() - begun, (folder / "own.nid").read_bytes()
    assert whole != SERIES["own.nid"]
    signals = itertools.cycle(SIGNALS)
    which, done = next(signals), 0
    while done < number:
        put(SERIES, folder)
        if killed(words, rng.uniform(0, seconds), which, folder) is None:
            continue
        found = [path.parent for path in folder.glob("runs/*/*/run.json")]
        if not found:
            if (folder / "own.nid").read_bytes() != SERIES["own.nid"]:
                yield which.name, "it has learned from nothing"
            continue
        yield which.name, series_harm(found[0].parent, folder, whole)
        done, which = done + 1, next(signals)


def series_harm(where: Path, folder: Path, whole: bytes) -> str:
    """What is wrong with what a series has written after a kill, and after it has gone on."""
    if ended(started(["check", "own.nid"], folder)) != 0:
        return "torn: own.nid"
    code = ended(started(["execute", "--resume", str(where), "--quiet"], folder))
    if code not in (0, 2, 3):  # 2: it had ended
        return f"--resume ends with {code}"
    if hidden := [str(path.relative_to(folder)) for path in folder.rglob(".*")]:
        return f"left over: {hidden}"
    return "" if (folder / "own.nid").read_bytes() == whole else "it has learned something else"


# ---- races


def save(path: Path, content: bytes, in_place: bool) -> None:
    """As editors do."""
    if in_place:
        path.write_bytes(content)
        return
    beside = path.parent / "editor's own"
    beside.write_bytes(content)
    beside.replace(path)


def begun_to_write(case: Case, folder: Path) -> int:
    """A command at work. `convert --force` replaces whatever it finds, and so has found its files already."""
    if case.name != "convert":
        return started(case.words, folder)
    reading, writing = os.pipe()
    child = started(case.words, folder, lambda: print(end="!", file=os.fdopen(writing, "w")))
    os.close(writing)
    os.read(reading, 1)
    os.close(reading)
    return child


def races(case: Case, number: int, rng: random.Random, folder: Path) -> Iterator[tuple[str, str]]:
    """How each race ended, and what went wrong."""
    for race in range(number):
        put(case.before, folder)
        in_place, often = race % 2 == 0, race % 4 >= 2
        child = begun_to_write(case, folder)
        time.sleep(rng.uniform(0, case.seconds))
        path = folder / case.edited
        for edit in range(rng.randint(2, 30) if often else 1):
            mark = f"# edit {edit}\n".encode()
            save(path, case.before[case.edited] + mark, in_place)
            time.sleep(rng.uniform(0, 2e-3))
        code = ended(child)
        now = path.read_bytes()
        kept = mark.strip() in now
        how = "edited last" if now == case.before[case.edited] + mark else "edited first"
        beside = [name for name in held(folder) if name not in case.after]
        wrong = "" if kept else "an edit was lost"
        yield (
            f"{how}, {'refused' if code == 1 and case.name != 'convert' else 'done'}",
            wrong or (f"left over: {beside}" if beside else ""),
        )


# ---- figures


HARMLESS = ("", "left")
"""`left`: a file that the next command removed."""


def told(title: str, found: Iterator[tuple[str, str]], number: int) -> bool:
    """Print what came of something, and whether nothing was wrong."""
    counted: Counter[str] = Counter()
    wrong: Counter[str] = Counter()
    begun = time.perf_counter()
    for done, (how, what) in enumerate(found, start=1):
        counted[how] += 1
        if what:
            wrong["parted by KILL" if (how, what) == ("SIGKILL", "parted") else what] += 1
        if sys.stderr.isatty():
            print(f"\r{title}: {done} of {number}", end="", file=sys.stderr, flush=True)
    if sys.stderr.isatty():
        print("\r", end="", file=sys.stderr)
    harmless = {*HARMLESS, "parted by KILL"}
    failures = sum(count for what, count in wrong.items() if what not in harmless)
    ways = ", ".join(f"{count} {how}" for how, count in sorted(counted.items()))
    said = "; ".join(f"{count} {what}" for what, count in sorted(wrong.items()))
    print(
        f"{title}: {counted.total()} ({ways}), {failures} failures"
        f"{f' ({said})' if said else ''}; {time.perf_counter() - begun:.0f} s",
        flush=True,
    )
    return failures == 0


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--kills", type=int, default=200, help="of each command")
    parser.add_argument("--races", type=int, default=100, help="with each writer")
    parser.add_argument("--seed", type=int, default=1, help="of the moments")
    parser.add_argument("--only", help="one command")
    asked = parser.parse_args()
    rng = random.Random(asked.seed)
    right = []
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(temporary) / "work"
        # Everything is loaded once, before the first process is forked.
        assert ended(started(["plan", "cleaning", "three_areas", "--samples", "50"], Path(temporary))) == 0
        warm(Path(temporary) / "warm")
        for name, case in cases().items():
            if asked.only in (None, name):
                rehearsed(case, folder)
                right.append(told(f"kills of {name}", kills(case, asked.kills, rng, folder), asked.kills))
                right.append(told(f"races with {name}", races(case, asked.races, rng, folder), asked.races))
        if asked.only in (None, "execute"):
            right.append(told("kills of execute", run_kills(asked.kills, rng, folder), asked.kills))
        if asked.only in (None, "series"):
            right.append(told("kills of a series", series_kills(asked.kills, rng, folder), asked.kills))
    print(f"load {os.getloadavg()[0]:.1f}")
    return 0 if all(right) else 1


def warm(folder: Path) -> None:
    """Load what the commands need, so that processes forked later need not."""
    from cleancli.cli.main import run

    folder.mkdir()
    before, kept = Path.cwd(), os.dup(1)
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.chdir(folder)
    os.dup2(nowhere, 1)
    try:
        run(["execute", "cleaning", "three_areas", "--seed", "5", "--samples", "50", "--quiet"])
        for case in cases().values():
            put(case.before, folder / case.name)
            os.chdir(folder / case.name)
            run(case.words)
    finally:
        os.dup2(kept, 1)
        os.chdir(before)


if __name__ == "__main__":
    sys.exit(main())
