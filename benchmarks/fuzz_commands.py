"""No file may crash or stall a command: `python benchmarks/fuzz_commands.py [KIND...] [--inputs N]`.

Kinds are `texts` (20,000 domains and problems with small changes that pass `check`, or have at most three
mistakes: fmt, show, explain, compile, plan, and a short simulate), `folders` (5,000 run folders: report,
learn, --resume) and `looks` (2,000 folders of frames, and scenes: perceive). Each input is tried in a process
of its own. A traceback, a death, an exit code that docs/exit-codes.md does not have, more than 10 s of
computing or 1 GB of memory, a change outside the folder, or a refused --resume that has changed something is
a failure: it is told in --keep, and the exit code is 1. What was tried is noted there, and not tried again.
"""

from __future__ import annotations

import argparse
import contextlib
import gc
import hashlib
import importlib
import io
import json
import multiprocessing
import os
import random
import re
import resource
import shutil
import signal
import sys
import tempfile
import time
import traceback
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import fuzz_inputs as inputs
from memory_limit import limit_memory

from cleancli.cli.command_table import COMMANDS
from cleancli.cli.exit_codes import ExitCode
from cleancli.cli.main import run
from cleancli.language.diagnostics.diagnostic import Level
from cleancli.language.diagnostics.refused import Refused
from cleancli.language.load import checked_domain, checked_problem, read_source
from cleancli.recording import run_folder

COUNTS = {"texts": 20_000, "folders": 5_000, "looks": 2_000}
SECONDS = 10
NEARLY = 3
"""Mistakes of a text that nearly passes the check."""

KEPT = 0.3
"""Share of those that only nearly pass which are tried: the others go farther."""

FEW = ("--samples", "30")
TABLES = 100
"""Run folders from which on some are of a table, which takes long to go on with."""

Commands = list[tuple[str, ...]]


@dataclass(frozen=True, slots=True)
class Tried:
    """What came of an input: in a word, what is wrong with it (nothing, if all is well), seconds, bytes."""

    number: int
    outcome: str
    wrong: str
    seconds: float
    memory: int


# ---- inputs


def texts(rng: random.Random, place: Path, _: Path) -> Commands | None:
    """A domain and a problem, one of them changed; None where they have many mistakes."""
    domain, problem = rng.choice(inputs.pairs())
    if rng.random() < 0.7:
        domain = inputs.text(domain, rng)
    else:
        problem = inputs.text(problem, rng)
    files = (place / "d.nid", place / "p.nid")
    for file, text in zip(files, (domain, problem), strict=True):
        file.write_bytes(text.encode("utf-8", "surrogatepass"))
    action = _nearly_right(*files, rng)
    if action is None:
        return None
    names = tuple(map(str, files))
    return [
        ("fmt", "--diff", *names),
        ("show", *names),
        ("explain", *names, action),
        ("compile", *names),
        ("plan", *names, *FEW),
        ("simulate", *names, "--episodes", "2", "--max-actions", "4", *FEW),
        ("fmt", *names),
    ]


def _nearly_right(domain: Path, problem: Path, rng: random.Random) -> str | None:
    """An action to explain; None where the two have many mistakes."""
    try:
        checked = checked_domain(read_source(domain))
        mistakes = [found for found in checked.diagnostics if found.level is Level.ERROR]
        if checked.model is None:
            return "wipe(a1)" if len(mistakes) <= NEARLY and rng.random() < KEPT else None
        found = checked_problem(read_source(problem), checked.model)
    except Refused:
        return None
    number = sum(each.level is Level.ERROR for each in found.diagnostics)
    if number > NEARLY or (number and rng.random() > KEPT):
        return None
    things = [thing.name for thing in found.model.objects] if found.model else ["a1"]
    for action in checked.model.actions:
        return f"{action.name}({', '.join((things or ['a1'])[:1] * len(action.parameters))})"
    return "wipe(a1)"


def folders(rng: random.Random, place: Path, bases: Path) -> Commands:
    """A run's folder with changes."""
    base = bases / rng.choices(("cut", "ended", "table"), (12, 3, 1))[0]
    shutil.copytree(base if base.exists() else bases / "cut", place / "run")
    inputs.folder(place / "run", place / "elsewhere", rng)
    name = str(place / "run")
    return [
        ("report", name),
        ("report", name, "--json"),
        ("learn", "cleaning", name),
        ("execute", "--resume", name),
    ]


def looks(rng: random.Random, place: Path, bases: Path) -> Commands:
    """Frames, or a scene, with changes."""
    if rng.random() < 0.15:
        scene = place / "s.nid"
        scene.write_text(inputs.text(rng.choice(inputs.scenes()), rng), encoding="utf-8", errors="replace")
        return [("perceive", str(scene), "--json")]
    shutil.copytree(bases / "frames", place / "run")
    inputs.folder(place / "run", place / "elsewhere", rng)
    words = ("perceive", str(place / "run" / "frames"), "--scene", str(place / "run" / "scene.nid"))
    options: tuple[tuple[str, ...], ...] = ((), ("--json",), ("--out", str(place / "out.png")))
    return [(*words, *rng.choice(options))]


KINDS: dict[str, Callable[[random.Random, Path, Path], Commands | None]] = {
    "texts": texts,
    "folders": folders,
    "looks": looks,
}


def prepare(bases: Path, kinds: list[str], tables: bool) -> None:
    """What folders and looks are made of: two runs without a table, one with if `tables` are wanted, and the
    frames of a look. Loads the planner too, which each input's process then has."""
    for name in COMMANDS:
        # Once, and not in each input's process.
        importlib.import_module(f"cleancli.cli.commands.{name.replace('-', '_')}")
    inputs.pairs()
    words = ["--quiet", *FEW, "--no-video"]
    symbolic = ["execute", "cleaning", "three_areas", "--seed", "5", *words]
    _run([*symbolic, "--runs", str(bases / "runs")])
    shutil.move(str(bases / "runs" / "three_areas-seed5-001"), bases / "ended")
    _cut([*symbolic, "--runs", str(bases / "runs")], 2)
    shutil.move(str(bases / "runs" / "three_areas-seed5-001"), bases / "cut")
    if tables and "folders" in kinds:
        table = ["execute", "cleaning", "two_groups", "--seed", "1", "--max-actions", "2", *words]
        _cut([*table, "--runs", str(bases / "runs")], 1)
        shutil.move(str(bases / "runs" / "two_groups-seed1-001"), bases / "table")
    if "looks" in kinds:
        frames = bases / "frames"
        frames.mkdir()
        _run(["perceive", "two_groups", "--save-frames", str(frames / "frames")])
        _run(["calibrate", "two_groups", "--out", str(frames / "c.json"), "--count", "2"])
        camera = 'camera { calibration = "c.json" '
        (frames / "scene.nid").write_text(re.sub(r"camera\s*\{", camera, inputs.scenes()[0]))
        _run(["perceive", str(frames / "frames"), "--scene", str(frames / "scene.nid")])
    gc.freeze()


class _Cut(BaseException):
    """Stands for a process that is gone."""


def _cut(words: list[str], actions: int) -> None:
    """A run that dies after so many actions."""
    checkpoint = run_folder.Recorder._checkpoint

    def dies(self: run_folder.Recorder, state: object) -> None:
        checkpoint(self, state)  # type: ignore[arg-type]
        if state.actions == actions:  # type: ignore[attr-defined]
            raise _Cut

    run_folder.Recorder._checkpoint = dies  # type: ignore[method-assign]
    try:
        _said(tuple(words))
    finally:
        run_folder.Recorder._checkpoint = checkpoint  # type: ignore[method-assign]


def _run(words: list[str]) -> None:
    code, said, wrong = _said(tuple(words))
    assert code in (0, 3), f"{words}: {said}{wrong}"


# ---- one input


def attempt(job: tuple[str, int, int, Path, Path]) -> Tried:
    """Draw the input of a number and try it; it is kept if something is wrong."""
    kind, seed, number, bases, keep = job
    with tempfile.TemporaryDirectory(prefix="fuzz-") as folder:
        place = Path(folder)
        (place / "elsewhere").mkdir()
        (place / "elsewhere" / "text").write_text("somebody's\n")
        tried = _isolated(kind, seed, number, place, bases)
        if tried.wrong:
            kept = keep / f"{kind}-{seed}-{number}"
            shutil.rmtree(kept, ignore_errors=True)
            kept.mkdir(parents=True)
            (kept / "wrong.txt").write_text(tried.wrong, encoding="utf-8", errors="replace")
        return tried


def _isolated(kind: str, seed: int, number: int, place: Path, bases: Path) -> Tried:
    """In a process of its own, which says in a pipe what came of it."""
    read, write = os.pipe()
    child = os.fork()
    if child == 0:
        try:
            os.close(read)
            with os.fdopen(write, "w", encoding="utf-8", errors="replace") as pipe:
                json.dump(_try(kind, random.Random(f"{seed} {kind} {number}"), place, bases), pipe)
            os._exit(0)
        finally:
            os._exit(1)
    os.close(write)
    with os.fdopen(read, encoding="utf-8", errors="replace") as pipe:
        said = pipe.read()
    _, status, usage = os.wait4(child, 0)
    seconds, memory = usage.ru_utime + usage.ru_stime, usage.ru_maxrss << 10
    if os.WIFSIGNALED(status):
        name = signal.Signals(os.WTERMSIG(status)).name
        return Tried(number, "death", f"died of {name}: {said}", seconds, memory)
    outcome, wrong = json.loads(said) if said else ("broken", "nothing was said: the benchmark is wrong")
    return Tried(number, outcome, wrong, seconds, memory)


def _try(kind: str, rng: random.Random, place: Path, bases: Path) -> tuple[str, str]:
    """The outcome in a word, and what is wrong."""
    os.chdir(place)
    os.dup2(os.open(os.devnull, os.O_WRONLY), 2)  # where libraries say what they like
    commands = KINDS[kind](rng, place, bases)
    while commands is None:
        commands = KINDS[kind](rng, place, bases)
    _limit()
    before = _content(place / "elsewhere")
    codes = []
    for words in commands:
        held, started = _content(place / "run") if "--resume" in words else {}, time.process_time()
        code, said, wrong = _said(words)
        if wrong or code not in set(ExitCode):
            return "crash", f"{words}: exit code {code}\n{wrong}{said[-2000:]}"
        if time.process_time() - started > SECONDS:
            return "slow", f"{words} took {time.process_time() - started:.1f} s"
        if (
            "--resume" in words
            and code in (ExitCode.REFUSED, ExitCode.USAGE)
            and _content(place / "run") != held
        ):
            return "changed", f"{words} was refused and has changed the folder\n{said}"
        codes.append(f"{words[0]} {int(code)}")
    if _content(place / "elsewhere") != before:
        return "outside", f"{commands} changed what is outside"
    failed = [code for code in codes if code[-2:] not in (" 0", " 3")]
    return failed[0] if failed else "passed", ""


def _said(words: tuple[str, ...]) -> tuple[int, str, str]:
    """The exit code of a command, what it says, and its traceback."""
    written, code, wrong = io.BytesIO(), -1, ""
    said = io.TextIOWrapper(written, "utf-8", "replace", write_through=True)
    with contextlib.redirect_stdout(said), contextlib.redirect_stderr(said):
        try:
            code = run(list(words))
        except BaseException:
            wrong = traceback.format_exc()
    return code, written.getvalue().decode("utf-8", "replace"), wrong


def _limit() -> None:
    """A process that computes for far too long, or asks for far too much memory, ends."""
    most = int(6 * SECONDS) + 1  # of all commands
    resource.setrlimit(resource.RLIMIT_CPU, (most, most))
    limit_memory()


def _content(folder: Path) -> dict[str, str]:
    """Hashes of the files of a folder, what changes by being looked at aside."""
    return {
        str(path.relative_to(folder)): hashlib.sha256(path.read_bytes()).hexdigest()
        for path in folder.rglob("*")
        if path.is_file() and not path.is_symlink() and path.stat().st_size < 1 << 24
    }


# ---- all of them


def tried_before(notes: Path, seed: int) -> dict[int, Tried]:
    """What an earlier call with this seed has tried."""
    if not notes.exists():
        return {}
    lines = notes.read_text(encoding="utf-8").split("\n")[:-1]
    return {entry[1]: Tried(*entry[1:]) for entry in map(json.loads, lines) if entry[0] == seed}


def attempts(kind: str, count: int, seed: int, bases: Path, keep: Path) -> Iterator[Tried]:
    """All inputs of a kind, both cores at work; what was tried before is not tried again."""
    keep.mkdir(parents=True, exist_ok=True)
    notes = keep / f"{kind}.jsonl"
    before = {number: tried for number, tried in tried_before(notes, seed).items() if number < count}
    yield from before.values()
    jobs = [(kind, seed, number, bases, keep) for number in range(count) if number not in before]
    with multiprocessing.Pool(2) as pool, notes.open("a", encoding="utf-8") as file:
        for done, tried in enumerate(pool.imap_unordered(attempt, jobs), start=len(before) + 1):
            values = [tried.number, tried.outcome, tried.wrong, round(tried.seconds, 2), tried.memory]
            file.write(json.dumps([seed, *values]) + "\n")
            file.flush()
            print(f"\r{kind}: {done} of {count}", end="", file=sys.stderr, flush=True)
            yield tried
    print(file=sys.stderr)


def told(kind: str, found: list[Tried]) -> int:
    """Print what came of the inputs of a kind; returns how many failed."""
    failures = [tried for tried in found if tried.wrong]
    for outcome, count in sorted(Counter(tried.outcome for tried in found).items()):
        print(f"{count:8}  {kind}: {outcome}")
    slowest = max(found, key=lambda tried: tried.seconds)
    largest = max(found, key=lambda tried: tried.memory)
    print(f"          slowest {slowest.seconds:.1f} s (number {slowest.number}, all its commands),", end=" ")
    print(f"largest {largest.memory >> 20} MB (number {largest.number})")
    print(f"{len(failures)} failures in {len(found)} {kind}")
    return len(failures)


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter,
        epilog="All of it computes for some two and a half hours on two cores; --inputs 200 five minutes.",
    )  # fmt: skip
    parser.add_argument("kinds", nargs="*", metavar="KIND", help="texts, folders, looks [default: all]")
    parser.add_argument("--inputs", type=int, help="so many of each kind [default: 20000, 5000, 2000]")
    parser.add_argument("--seed", type=int, default=1, help="of everything that is drawn [default: 1]")
    parser.add_argument("--keep", type=Path, default=Path("fuzz-commands"), help="[default: fuzz-commands]")
    parser.add_argument("--only", type=int, help="try the input of this number alone, and leave it in --keep")
    options = parser.parse_args()
    kinds = options.kinds or list(KINDS)
    if unknown := set(kinds) - set(KINDS):
        parser.error(f"there is no kind {', '.join(sorted(unknown))}")
    with tempfile.TemporaryDirectory(prefix="fuzz-bases-") as folder:
        bases, keep = Path(folder), options.keep.resolve()
        os.chdir(folder)
        prepare(bases, kinds, options.only is not None or (options.inputs or TABLES) >= TABLES)
        if options.only is not None:
            place = keep / f"{kinds[0]}-{options.seed}-{options.only}" / "files"
            shutil.rmtree(place, ignore_errors=True)
            (place / "elsewhere").mkdir(parents=True)
            print(_isolated(kinds[0], options.seed, options.only, place, bases))
            return 0
        failures = sum(
            told(kind, list(attempts(kind, options.inputs or COUNTS[kind], options.seed, bases, keep)))
            for kind in kinds
        )
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
