"""No PDDL file may crash or stall what reads it: `python benchmarks/fuzz_pddl.py [files] [--seed N]`.

The files of tests/corpus, and drawn ones in which their constructs meet, are changed: words and groups are
lost, doubled, moved and exchanged with those of other files, numbers and signs put in. Each is converted to
texts, read as commands read it, and grounded. A failure is an exception other than Refused, a mistake without
a place in the file, a mistake in a text that was written, or a file that takes longer than 5 s of CPU or asks
for more than 1 GB of memory; it is kept (`--keep FOLDER`), and the exit code is 1. 50,000 take about ten
minutes on one core.
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
from cleancli.conversion.pddl.convert import Wishes, convert
from cleancli.conversion.pddl.models import defines_problem, models_of
from cleancli.language.diagnostics.diagnostic import Level, Source
from cleancli.language.diagnostics.refused import Refused
from cleancli.language.diagnostics.render import render

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))
from support.pddl_drawn import Drawn

CORPUS = Path(__file__).resolve().parents[1] / "tests" / "corpus"
LIMIT = 5.0
"""CPU seconds that a file may take."""
LARGEST = 50_000
DRAWN = 200
"""Drawn files beside those of the corpus."""
TOKEN = re.compile(r";[^\n]*|[()]|[^\s();]+|\s+")
WORDS = """
    and or not imply exists forall when probabilistic increase decrease assign = < either object define domain
    problem total-cost reward :types :constants :predicates :functions :action :parameters :precondition
    :effect :init :objects :goal :metric :goal-reward :goal-probability :derived :durative-action minimize
    maximize ( ) )))) (((( - ? ?x : ; 1/0 0 1 -1 0.5 1e99 99999999999999999999 () (and) (total-cost) é
"""
ODD = (
    *WORDS.split(),
    "\x00",
    "(increase (reward) 2)",
    "(probabilistic 1/2 (ready))",
    "(forall (?o - object) (ready))",
)


def corpus() -> tuple[list[str], ...]:
    """The tokens of the files that are changed."""
    texts = [path.read_text(encoding="utf-8") for path in sorted(CORPUS.glob("*.pddl"))]
    texts += [Drawn(Random(number)).text() for number in range(DRAWN)]
    return tuple(TOKEN.findall(text) for text in texts)


# ---- changes


def group_at(tokens: list[str], start: int) -> int:
    """Where the group or word that begins at a token ends."""
    depth = 0
    for place in range(start, len(tokens)):
        depth += (tokens[place] == "(") - (tokens[place] == ")")
        if depth <= 0:
            return place + 1
    return len(tokens)


def _piece(tokens: list[str], rng: Random, kind: str) -> tuple[int, int]:
    """Where a group begins and ends, or a word, or any token; an empty piece where there is none."""
    signs = {"group": {"("}, "word": set(tokens) - {"(", ")"}}.get(kind, set(tokens))
    starts = [place for place, token in enumerate(tokens) if token in signs and not token.isspace()]
    if not starts:
        return 0, 0
    start = rng.choice(starts)
    return start, group_at(tokens, start) if kind == "group" else start + 1


def changed(tokens: list[str], others: list[str], rng: Random) -> list[str]:
    """The tokens with one change; `others` are those of a file that pieces may come from."""
    kind = rng.choice(("group", "group", "word", "word", "token"))
    start, end = _piece(tokens, rng, kind)
    piece = tokens[start:end]
    match rng.randrange(7):
        case 0:
            piece = []
        case 1:
            piece = [*piece, " "] * rng.choice((2, 2, 3, 40))
        case 2:
            piece = [rng.choice(ODD), " "]
        case 3:
            first, last = _piece(others, rng, kind)
            piece = [*others[first:last], " "]
        case 4:
            first, last = _piece(tokens, rng, kind)
            piece = [*tokens[first:last], " "]
        case 5:
            piece = ["(", rng.choice(("and", "not", "or", "when", "probabilistic 1/3")), " ", *piece, ")"]
        case _:
            return tokens[: rng.randrange(len(tokens) + 1)] if rng.random() < 0.2 else tokens
    return [*tokens[:start], *piece, *tokens[end:]]


def mutated(texts: tuple[list[str], ...], rng: Random) -> str:
    """A changed text."""
    tokens = rng.choice(texts)
    for _ in range(rng.choice((1, 1, 1, 1, 1, 2, 3, 6))):
        tokens = changed(tokens, rng.choice(texts), rng)
    return "".join(tokens)[:LARGEST]


# ---- what is done with a file


def used(text: str) -> str:
    """What came of a file. Raises AssertionError for what must not be."""
    source = Source("changed.pddl", text)
    try:
        made = convert([source], Wishes())
    except Refused as refused:
        _assert_placed(refused, text)
        return "refused"
    wrong = [each for each in made.diagnostics if each.level is Level.ERROR]
    assert not wrong, f"the text that was written has a mistake: {wrong[0]}"
    try:
        models = models_of(source, source if defines_problem(source) else None)
        for problem in models.problems:
            ground(models.domain, problem)
    except Refused as refused:
        _assert_placed(refused, text)
        return "refused later"
    return "mended" if made.diagnostics else "converted"


def _assert_placed(refused: Refused, text: str) -> None:
    assert refused.diagnostics, "refused without a word"
    for each in refused.diagnostics:
        size = is_sized(each.code)
        assert each.span is not None or size, f"no place: {each}"
        assert each.span is None or 0 <= each.span.start <= each.span.end <= len(text), f"outside: {each}"
    render(refused.diagnostics, refused.sources)


def is_sized(code: str) -> bool:
    """Whether a mistake is that a problem is too large, which is nowhere in particular."""
    return code.startswith("E60")


def attempt(text: str) -> tuple[str, str, float]:
    """The outcome of a text, what is wrong with it ("" for nothing), and CPU seconds."""
    started = time.process_time()
    try:
        outcome, wrong = used(text), ""
    except Exception:
        outcome, wrong = "failure", traceback.format_exc()
    took = time.process_time() - started
    return (outcome, wrong, took) if wrong or took <= LIMIT else ("slow", f"took {took:.1f} s", took)


def main() -> int:
    """Try them all; the exit code."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("files", type=int, nargs="?", default=50_000)
    parser.add_argument("--keep", type=Path, help="a folder for failures; a new one if none is named")
    parser.add_argument("--seed", type=int, default=0, help="of the first file; each has its own")
    options = parser.parse_args()
    texts, counts, slowest, failures = corpus(), Counter[str](), 0.0, 0
    limit_memory()
    for seed in range(options.seed, options.seed + options.files):
        text = mutated(texts, Random(seed))
        outcome, wrong, took = attempt(text)
        counts[outcome] += 1
        slowest = max(slowest, took)
        if wrong:
            failures += 1
            folder = options.keep or Path(tempfile.mkdtemp(prefix="fuzz-pddl-"))
            options.keep = folder
            folder.mkdir(parents=True, exist_ok=True)
            (folder / f"{seed}.pddl").write_text(text, encoding="utf-8")
            print(f"seed {seed}: {wrong.strip().splitlines()[-1]} (kept in {folder})", flush=True)
        if (seed + 1 - options.seed) % 5000 == 0:
            print(f"{seed + 1 - options.seed} files", flush=True)
    told = ", ".join(f"{count} {outcome}" for outcome, count in sorted(counts.items()))
    print(f"{failures} failures in {options.files} files; the slowest took {slowest:.2f} s")
    print(f"{told}; the process held at most {greatest_memory() >> 20} MB")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
