"""No text may crash or stall the checker: `python benchmarks/fuzz.py [inputs] [--keep FOLDER] [--seed N]`.

Shipped files, the tests' files and their cases of mistakes are mutated, byte by byte and token by token, and
go through everything that reads files: decoding, parsing and checking of domains, problems (with their
domain) and scenes, and of recorded experience. An exception other than Refused, a diagnostic that points
outside the text, or an input that takes longer than a second is a failure: it is kept in FOLDER, and the exit
code is 1. 200,000 inputs take about an hour of CPU; how many are done is said as it goes.
"""

from __future__ import annotations

import argparse
import functools
import multiprocessing
import random
import re
import sys
import tempfile
import time
import traceback
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

from cleancli.language.diagnostics.diagnostic import Diagnostic
from cleancli.language.diagnostics.refused import Refused
from cleancli.language.diagnostics.render import as_sarif, render
from cleancli.language.load import kind_of, load_domain, load_problem, read_source
from cleancli.language.model import Domain
from cleancli.language.parsing.grammar import grammar
from cleancli.learning.experience import read_experience
from cleancli.scene.check import load_scene

ROOT = Path(__file__).resolve().parents[1]
FOLDERS = ("domains", "problems", "benchmarks", "tests/language", "tests/golden", "tests/cases")
LIMIT = 1.0
LARGEST = 200_000
SLOWEST_SHOWN = 5
TOKEN = re.compile(r"#[^\r\n]*|\?\w+|\w+(?:\.\d+)?|:=|=>|[<>!]=|\s+|.", re.DOTALL)
ODD = (
    "\ufeff", "\0", "\r", "\x1b", "\u2028", "\u00a0", "é", "𝛼", "?", "{", "}", "{" * 300, "(" * 300,
    "9" * 500, "1/0", "0.0000000001", f"1/{'9' * 400}", "1" + "0" * 29, "\t" * 50, "not " * 50, "#",
    "\n" * 50, "[", "]]",
)  # fmt: skip


@dataclass(frozen=True, slots=True)
class Corpus:
    """What is mutated, and the words to do it with."""

    seeds: tuple[tuple[str, bytes], ...]
    words: tuple[str, ...]
    domain: Domain


@dataclass(frozen=True, slots=True)
class Failure:
    """An input that was not treated as it should, and why."""

    suffix: str
    data: bytes
    reason: str


@dataclass(frozen=True, slots=True)
class Report:
    """What came of some inputs: how many of each outcome, the slowest, and the failures."""

    outcomes: Counter[str]
    slowest: tuple[tuple[float, str], ...]
    failures: tuple[Failure, ...]


@functools.cache
def corpus() -> Corpus:
    """All text files that the checkout has for the language."""
    paths = sorted(
        path
        for folder in FOLDERS
        for suffix in ("nid", "jsonl")
        for path in (ROOT / folder).rglob(f"*.{suffix}")
    )
    seeds = tuple((path.suffix, path.read_bytes()) for path in paths)
    patterns = [terminal.pattern.value for terminal in grammar().terminals]
    words = {word for word in patterns if re.fullmatch(r"[a-z][a-z0-9]*|[^\w\\\[]{1,2}", word)}
    domain = load_domain(read_source(ROOT / "tests" / "language" / "small.nid"))
    return Corpus(seeds, (*sorted(words), *ODD), domain)


# ---- mutations


def _span(rng: random.Random, length: int, longest: int) -> tuple[int, int]:
    start = rng.randrange(length + 1)
    return start, min(length, start + rng.randint(1, longest))


def _bytes_changed(data: bytes, rng: random.Random) -> bytes:
    start, end = _span(rng, len(data), 40)
    piece = data[start:end]
    match rng.randrange(5):
        case 0:
            piece = b""
        case 1:
            piece *= rng.choice((2, 2, 2, 50))
        case 2:
            piece = bytes(rng.randrange(256) for _ in range(rng.randint(1, 4)))
        case 3:
            piece = bytes(byte ^ (1 << rng.randrange(8)) for byte in piece[:1]) + piece[1:]
        case _:
            piece = piece[::-1]
    return data[:start] + piece + data[end:]


def _tokens_changed(data: bytes, rng: random.Random) -> bytes:
    tokens = TOKEN.findall(data.decode("utf-8", "replace"))
    start, end = _span(rng, len(tokens), rng.choice((1, 1, 3, 12)))
    piece = tokens[start:end]
    match rng.randrange(5):
        case 0:
            piece = []
        case 1:
            piece *= rng.choice((2, 2, 2, 30))
        case 2:
            rng.shuffle(piece)
        case 3:
            piece = [rng.choice(corpus().words), " "]
        case _:
            other = rng.choice(corpus().seeds)[1].decode("utf-8", "replace")
            others = TOKEN.findall(other)
            first, last = _span(rng, len(others), 60)
            piece = others[first:last]
    return "".join([*tokens[:start], *piece, *tokens[end:]]).encode("utf-8", "surrogatepass")


def _names_swapped(data: bytes, rng: random.Random) -> bytes:
    """One word of the text in the place of another: most such texts still parse, and reach the check."""
    tokens = TOKEN.findall(data.decode("utf-8", "replace"))
    words = [number for number, token in enumerate(tokens) if re.match(r"[?\w]", token)]
    if words:
        tokens[rng.choice(words)] = tokens[rng.choice(words)]
    return "".join(tokens).encode("utf-8", "surrogatepass")


def _nested(data: bytes, rng: random.Random) -> bytes:
    at = rng.randrange(len(data) + 1)
    opening, closing = rng.choice(((b"{", b"}"), (b"(", b")"), (b"[", b"]"), (b"a { ", b" }"), (b"[", b"")))
    depth = rng.choice((3, 50, 2000))
    return data[:at] + opening * depth + closing * depth + data[at:]


_MUTATIONS: tuple[Callable[[bytes, random.Random], bytes], ...] = (
    *(_bytes_changed,) * 6,
    *(_tokens_changed,) * 12,
    *(_names_swapped,) * 8,
    _nested,
)


def mutated(rng: random.Random) -> tuple[str, bytes]:
    """A file's suffix and its changed content, of at most LARGEST bytes."""
    suffix, data = rng.choice(corpus().seeds)
    for _ in range(rng.choice((1, 1, 1, 2, 3, 8))):
        data = rng.choice(_MUTATIONS)(data, rng)[:LARGEST]
    return suffix, data


# ---- what is done with an input


def _use(path: Path) -> str:
    source = read_source(path)
    if path.suffix == ".jsonl":
        return f"experience of {min(len(tuple(read_experience(path, corpus().domain))), 9)} lines"
    kind = kind_of(source)
    match kind:
        case "domain":
            load_domain(source)
        case "problem":
            load_problem(source, corpus().domain)
        case _:
            load_scene(source)
    return kind


def _outside(diagnostics: tuple[Diagnostic, ...], data: bytes) -> bool:
    spans = [diagnostic.span for diagnostic in diagnostics if diagnostic.span is not None]
    return any(not 0 <= span.start <= span.end <= len(data) for span in spans)


def try_input(path: Path, data: bytes) -> tuple[str, str]:
    """The outcome of the file at `path`, which holds `data`, and what is wrong with it ("" for nothing)."""
    try:
        return _use(path), ""
    except Refused as refused:
        if not refused.diagnostics or _outside(refused.diagnostics, data):
            return "misplaced", "no diagnostic, or one outside the text"
        try:
            render(refused.diagnostics, refused.sources)
            as_sarif(refused.diagnostics, refused.sources)
        except Exception:
            return "render crash", traceback.format_exc()
        return f"refused {refused.diagnostics[0].code}", ""
    except Exception:
        return "crash", traceback.format_exc()


def fuzz(inputs: int, seed: int) -> Report:
    """Try `inputs` mutated inputs; the same seed gives the same ones."""
    with tempfile.TemporaryDirectory() as folder:
        return _fuzz(inputs, seed, Path(folder))


def _fuzz(inputs: int, seed: int, folder: Path) -> Report:
    rng = random.Random(seed)
    outcomes: Counter[str] = Counter()
    failures = []
    times = []
    for number in range(inputs):
        suffix, data = mutated(rng)
        path = folder / f"input{suffix}"
        path.write_bytes(data)
        started = time.process_time()
        outcome, wrong = try_input(path, data)
        seconds = time.process_time() - started
        if not wrong and seconds > LIMIT:
            wrong = f"took {seconds:.2f} s"
        outcomes[outcome] += 1
        times.append((seconds, f"input {number} of seed {seed}: {len(data)} bytes of {suffix}, {outcome}"))
        if wrong:
            failures.append(Failure(suffix, data, wrong))
        if len(times) > 1000:
            times = sorted(times)[-SLOWEST_SHOWN:]
    return Report(outcomes, tuple(sorted(times)[-SLOWEST_SHOWN:]), tuple(failures))


def _keep(failures: tuple[Failure, ...], folder: Path) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    for number, failure in enumerate(failures):
        (folder / f"{number:04}{failure.suffix}").write_bytes(failure.data)
        (folder / f"{number:04}.txt").write_text(failure.reason, encoding="utf-8")


def _reports(inputs: int, seed: int) -> Iterator[Report]:
    """Both cores at work, in shares of 1,000 inputs with a seed of their own."""
    shares = [min(1000, inputs - first) for first in range(0, inputs, 1000)]
    with multiprocessing.Pool(2) as pool:
        work = [pool.apply_async(fuzz, (share, seed + number)) for number, share in enumerate(shares)]
        for number, result in enumerate(work, start=1):
            yield result.get()
            print(f"\r{number * 1000:8} inputs", end="", file=sys.stderr, flush=True)
    print(file=sys.stderr)


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("inputs", nargs="?", type=int, default=200_000)
    parser.add_argument("--keep", type=Path, default=Path("fuzz-failures"))
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    reports = list(_reports(options.inputs, options.seed * 1_000_000))
    outcomes = sum((report.outcomes for report in reports), Counter[str]())
    for outcome, count in sorted(outcomes.items()):
        print(f"{count:8}  {outcome}")
    print("slowest:")
    for seconds, what in sorted((entry for report in reports for entry in report.slowest), reverse=True)[:5]:
        print(f"{seconds:8.3f} s  {what}")
    failures = tuple(failure for report in reports for failure in report.failures)
    print(f"{len(failures)} failures in {outcomes.total()} inputs")
    if failures:
        _keep(failures, options.keep)
        print(f"kept in {options.keep}")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
