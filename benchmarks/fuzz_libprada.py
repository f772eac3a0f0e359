"""No files of libPRADA may crash or stall what reads them: `python benchmarks/fuzz_libprada.py [files]`.

The kitchen of the tests and the cleaning rules of benchmarks/libprada are changed: words and lines are lost,
doubled and exchanged, numbers and signs put in, and so are a reward and experience beside them. All files are
converted, and what can be converted is grounded and written for libPRADA again. A failure is an exception
other than Refused, a mistake without a place, or files that take longer than 5 s of CPU or ask for more than
1 GB of memory; they are kept (`--keep FOLDER`), and the exit code is 1. 20,000 take about eleven minutes on
one core.
"""

from __future__ import annotations

import argparse
import re
import sys
import tempfile
import time
import traceback
from collections import Counter
from pathlib import Path
from random import Random

from memory_limit import greatest_memory, limit_memory

from cleancli.compiler.ground import ground
from cleancli.conversion.convert import Wishes, convert
from cleancli.conversion.experience.data import recorded
from cleancli.conversion.export.libprada import libprada
from cleancli.conversion.export.unsaid import Unsaid
from cleancli.language.diagnostics.diagnostic import Level, Source
from cleancli.language.diagnostics.refused import Refused
from cleancli.language.diagnostics.render import render
from cleancli.language.load import load_domain, load_problem

HERE = Path(__file__).resolve().parent
KITCHEN = HERE.parent / "tests" / "conversion" / "kitchen"
LIMIT = 5.0
"""CPU seconds that files may take."""
FILES = ("rules.dat", "state.dat", "symbols.dat", "reward.dat", "data.dat")
TOKEN = re.compile(r"[A-Za-z_0-9.]+|\s+|.")
FACT = re.compile(r"dirt\([^)]*\)")
WORDS = """
    ACTION: CONTEXT: OUTCOMES: default() -- <no-change> <noise> -dirt(X) dirt(X) X 7 99 1e9 0.5 1.7 -1 = >= !=
    <-- Num count integers binary primitive action transclosure ( ) # \x00 é
"""
ODD = (*WORDS.split(), "#rules = 3")

Texts = dict[str, str]


def corpus() -> tuple[Texts, ...]:
    """The files that are changed."""
    kitchen = {name: (KITCHEN / name).read_text(encoding="utf-8") for name in FILES[:3]}
    shared = {
        name: (HERE / "libprada" / name).read_text(encoding="utf-8") for name in ("rules.dat", "symbols.dat")
    }
    states = [
        path.read_text(encoding="utf-8") for path in sorted((HERE / "libprada").glob("d[24].state.dat"))
    ]
    return tuple(with_experience(each) for each in (kitchen, *({**shared, "state.dat": s} for s in states)))


def with_experience(texts: Texts) -> Texts:
    """The files, with a reward for dirt, and with an action that changed nothing."""
    state = " ".join(texts["state.dat"].split("\n"))
    action, terms = re.findall(r"ACTION:\s+(\w+)\((.*?)\)", texts["rules.dat"])[1]
    (number, *_) = re.findall(r"\((\d+)", state)
    names = " ".join(number for _ in terms.split())
    data = f"{state}\n{action}({names})\n{state}\n"
    return {**texts, "reward.dat": f"1\n{FACT.findall(state)[0]}\n", "data.dat": data}


def mutated(texts: tuple[Texts, ...], rng: Random) -> Texts:
    """All files, of which some are changed."""
    found = dict(rng.choice(texts))
    for _ in range(rng.choice((1, 1, 1, 2, 3, 6))):
        name = rng.choice(FILES)
        found[name] = _changed(found[name], rng.choice(texts)[name], rng)
    return found


def _changed(text: str, other: str, rng: Random) -> str:
    by_line = rng.random() < 0.3
    parts, others = [
        each.splitlines(keepends=True) if by_line else TOKEN.findall(each) for each in (text, other)
    ]
    start = rng.randrange(len(parts) + 1)
    end = min(len(parts), start + rng.choice((0, 1, 1, 2, 5)))
    match rng.randrange(5):
        case 0:
            piece: list[str] = []
        case 1:
            piece = parts[start:end] * 2
        case 2:
            first = rng.randrange(len(others) + 1)
            piece = others[first : first + rng.choice((1, 1, 2, 5))]
        case 3:
            piece = [f" {rng.choice(ODD)} "]
        case _:
            return text[: rng.randrange(len(text) + 1)] if rng.random() < 0.2 else text
    return "".join([*parts[:start], *piece, *parts[end:]])


def used(texts: Texts) -> str:
    """What came of some files. Raises AssertionError for what must not be."""
    rules, state, symbols, reward, data = (Source(name, texts[name]) for name in FILES)
    try:
        made = convert(rules, state, symbols, Wishes(reward="cost"), ("domain.nid", "problem.nid"), reward)
        recorded(data, made)
    except Refused as refused:
        _assert_placed(refused, texts)
        return "refused"
    if any(each.level is Level.ERROR for each in made.diagnostics):
        render(made.diagnostics, made.sources)
        return "converted with a mistake"
    domain = load_domain(made.sources[0])
    problem = load_problem(made.sources[1], domain)
    try:
        ground(domain, problem)
        libprada(domain, problem, "unchanged", Unsaid("libPRADA", [made.sources[0]]))
    except Refused as refused:
        render(refused.diagnostics, refused.sources)
        return "converted, refused later"
    return "converted, and written again"


def _assert_placed(refused: Refused, texts: Texts) -> None:
    assert refused.diagnostics, "refused without a word"
    for each in refused.diagnostics:
        assert each.span is not None, f"no place: {each}"
        assert each.span.path not in texts or each.span.end <= len(texts[each.span.path]), f"outside: {each}"
    render(refused.diagnostics, refused.sources)


def attempt(texts: Texts) -> tuple[str, str, float]:
    """The outcome of some files, what is wrong with it ("" for nothing), and CPU seconds."""
    started = time.process_time()
    try:
        outcome, wrong = used(texts), ""
    except Exception:
        outcome, wrong = "failure", traceback.format_exc()
    took = time.process_time() - started
    return (outcome, wrong, took) if wrong or took <= LIMIT else ("slow", f"took {took:.1f} s", took)


def main() -> int:
    """Try them all; the exit code."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("files", type=int, nargs="?", default=20_000, help="how many times all files")
    parser.add_argument("--keep", type=Path, help="a folder for failures; a new one if none is named")
    parser.add_argument("--seed", type=int, default=0, help="of the first; each has its own")
    options = parser.parse_args()
    texts, counts, slowest, failures = corpus(), Counter[str](), 0.0, 0
    limit_memory()
    for seed in range(options.seed, options.seed + options.files):
        found = mutated(texts, Random(seed))
        outcome, wrong, took = attempt(found)
        counts[outcome] += 1
        slowest = max(slowest, took)
        if wrong:
            failures += 1
            options.keep = options.keep or Path(tempfile.mkdtemp(prefix="fuzz-libprada-"))
            folder = options.keep / f"{seed}"
            folder.mkdir(parents=True, exist_ok=True)
            for name, text in found.items():
                (folder / name).write_text(text, encoding="utf-8")
            print(f"seed {seed}: {wrong.strip().splitlines()[-1]} (kept in {folder})", flush=True)
    told = ", ".join(f"{count} {outcome}" for outcome, count in sorted(counts.items()))
    print(f"{failures} failures in {options.files} files; the slowest took {slowest:.2f} s")
    print(f"{told}; the process held at most {greatest_memory() >> 20} MB")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
