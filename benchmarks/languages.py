"""Domains as files of other languages, and back: `python benchmarks/languages.py [domains] [--seed N]`.

The shipped domains, those of benchmarks/domains and so many drawn ones, of which every second is drawn by
tests/support/differential, are written as PPDDL and for libPRADA. In random states what the files mean (by a
direct interpreter) is compared with what the domain means: what follows an action, to the last digit, and as
PPDDL what is paid for it. Then the files are converted back, and what follows must be as likely to 1e-9. What
was lost, and what was refused, is counted by its reason. Exit code 1, with the domain, where something
differs. 500 domains and 200 states of each take about ten minutes of CPU time.

With `--rddl N` three domains are written as RDDL instead, pyRDDLGym draws so many transitions of each, and
their frequencies are compared with the rules (chi-squared); then it cleans for 200 steps. 10,000 take about
six minutes of CPU time.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from contextlib import suppress
from dataclasses import dataclass
from itertools import chain
from pathlib import Path
from random import Random

import numpy as np

from cleancli.language.diagnostics.diagnostic import Level, Source
from cleancli.language.diagnostics.refused import Refused
from cleancli.language.load import load_domain, load_problem, read_source
from cleancli.language.model import Domain, Problem
from cleancli.resources import shipped

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))
from support import exported_libprada, exported_ppddl, exported_rddl, libprada_round_trips, round_trips
from support.differential.drawing import draw
from support.differential.writing import Writer
from support.random_domains import Generator

Given = tuple[str, Domain, Problem]


def files(rng: np.random.Generator) -> Iterator[Given]:
    """The domains that come as files, each with a problem that is drawn."""
    for path in sorted([*shipped("domains").glob("*.nid"), *Path(__file__).parent.glob("domains/*.nid")]):
        domain = load_domain(read_source(path))
        yield path.stem, domain, round_trips.drawn_problem(domain, rng)


def drawn(number: int, first: int, folder: Path) -> Iterator[Given]:
    """So many domains with their problems, from a seed on; those that the checker refuses do not count."""
    seed = first
    while number:
        if seed % 2 == 0:
            generator = Generator(seed)
            given: Given | None = f"seed {seed}", generator.domain(), generator.problem()
        else:
            given = _of_differential(seed, folder)
        seed += 1
        if given is not None:
            number -= 1
            yield given


def _of_differential(seed: int, folder: Path) -> Given | None:
    domain, problem = draw(seed)
    writer = Writer(Random(seed))
    text, base = writer.domain(domain)
    if base is not None:
        (folder / "base.nid").write_text(base, encoding="utf-8")
    try:
        model = load_domain(Source(str(folder / "domain.nid"), text))
        said = Source("problem.nid", writer.problem(problem, domain))
        return f"seed {seed}", model, load_problem(said, model)
    except Refused:
        return None


@dataclass(frozen=True)
class Language:
    """How domains are written in a language, and come back: `differ` tells where the files do something else,
    and `returned` what differs first of what has come back, and what was lost."""

    name: str
    written: str
    differ: Callable[[Domain, Problem, int, np.random.Generator], Iterator[str]]
    returned: Callable[[Domain, Problem, int, np.random.Generator], tuple[str, Iterable[str]]]


def from_ppddl(
    domain: Domain, problem: Problem, states: int, rng: np.random.Generator
) -> tuple[str, Iterable[str]]:
    """What differs first where the domain has been PPDDL, and what was lost."""
    back = round_trips.through_ppddl(domain, problem)
    return next(round_trips.disagreements(domain, problem, back, states, rng), ""), back.lost


def from_libprada(
    domain: Domain, problem: Problem, states: int, rng: np.random.Generator
) -> tuple[str, Iterable[str]]:
    """What differs first where the domain has been libPRADA's files; nothing else is lost."""
    back = libprada_round_trips.through_libprada(domain, problem)
    return next(libprada_round_trips.disagreements(domain, problem, back, states, rng), ""), ()


COMPARED = {
    "ppddl": Language("PPDDL", "as PPDDL", exported_ppddl.disagreements, from_ppddl),
    "libprada": Language("libPRADA", "for libPRADA", exported_libprada.disagreements, from_libprada),
}


def difference(
    language: Language, given: Given, states: int, rng: np.random.Generator, counts: Counter[str]
) -> str:
    """What differs in a language, if anything does; what was compared and what was lost is counted."""
    name, domain, problem = given
    try:
        if found := next(language.differ(domain, problem, states, rng), ""):
            return f"{name}, {language.name}: {found}"
        counts[f"written {language.written}, the same in all states"] += 1
        found, lost = language.returned(domain, problem, states, rng)
    except Refused as refused:
        counts[_refusal(language.name, refused)] += 1
        return ""
    counts[f"came back from {language.name}, the same in all states"] += not found
    counts.update(f"lost on the way back from {language.name}: {each}" for each in lost)
    return f"{name}, back from {language.name}: {found}" if found else ""


def _refusal(language: str, refused: Refused) -> str:
    """The reasons for which something was refused, each once: warnings are none."""
    mistakes = [each for each in refused.diagnostics if each.level is Level.ERROR]
    return f"{language} refused: {', '.join(sorted({_reason(each.message) for each in mistakes}))}"


def _reason(message: str) -> str:
    """A message without the names that stand in it."""
    return "".join(part if number % 2 == 0 else "..." for number, part in enumerate(message.split("`")))


RDDL = ("cleaning", "tireworld", "exploding")
STEPS = 200
UNLIKELY = 0.001
"""Chance below which frequencies are taken to differ."""


def _varied(
    domain: Domain, problem: Problem
) -> tuple[tuple[str, tuple[str, ...]], dict[exported_rddl.After, float]]:
    """The action that can have the most results in the first state, and how likely each is."""
    found = []
    for call in exported_ppddl.calls(domain, problem):
        with suppress(Refused):  # an outcome gives something two values (E602)
            found.append((call, exported_rddl.expected(domain, problem, *call)))
    return max(found, key=lambda each: len(each[1]))


def drawn_in_rddl(draws: int, seed: int, folder: Path) -> bool:
    """Whether pyRDDLGym draws what the rules say; prints what it draws."""
    right = True
    rng = np.random.default_rng(seed)
    for name, domain, problem in files(rng):
        if name not in RDDL:
            continue
        chosen, likely = _varied(domain, problem)
        while len(likely) < 2:  # no rule with several outcomes covers the state that was drawn
            problem = round_trips.drawn_problem(domain, rng)
            chosen, likely = _varied(domain, problem)
        simulated = exported_rddl.Simulated(domain, problem, folder, STEPS)
        found, _ = simulated.drawn(*chosen, draws, seed)
        chance = exported_rddl.chance_of(found, likely)
        right &= chance > UNLIKELY
        print(f"{name}, {chosen}: {draws} draws of {len(likely)} results, chance {chance:.3f}")
        if name == "cleaning":
            simulated.reset(seed)
            every = list(exported_ppddl.calls(domain, problem))
            total = sum(simulated.step(*every[int(rng.integers(len(every)))])[1] for _ in range(STEPS))
            print(f"{name}: {STEPS} steps, reward {total:g}")
    return right


def main() -> int:
    """Compare them all; the exit code."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("domains", type=int, nargs="?", default=500, help="how many are drawn")
    parser.add_argument("--states", type=int, default=200, help="random states of each")
    parser.add_argument("--seed", type=int, default=0, help="of the first domain that is drawn")
    parser.add_argument("--only", choices=tuple(COMPARED), help="one language alone")
    parser.add_argument("--rddl", type=int, metavar="N", help="draw so many transitions in RDDL instead")
    options = parser.parse_args()
    if options.rddl is not None:
        with tempfile.TemporaryDirectory() as folder:
            return 0 if drawn_in_rddl(options.rddl, options.seed, Path(folder)) else 1
    rng = np.random.default_rng(options.seed)
    counts: Counter[str] = Counter()
    with tempfile.TemporaryDirectory() as folder:
        for given in chain(files(rng), drawn(options.domains, options.seed, Path(folder))):
            counts["domains"] += 1
            for language in COMPARED.values() if options.only is None else (COMPARED[options.only],):
                if wrong := difference(language, given, options.states, rng, counts):
                    print(wrong)
                    return 1
    for what, count in counts.most_common():
        print(f"{count:5} {what}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
