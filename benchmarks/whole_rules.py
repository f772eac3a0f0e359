"""Whole rules from experience: python benchmarks/whole_rules.py [FOLDER] [--flicker SHARE...] [--seed N]

Hides the rules of domains, learns them from transitions alone (`cleancli learn --structure`), and says how
far the states that are foretold for held-out transitions are from those that the hidden rules foretell (total
variation, in the mean), beside the same of the hidden rules with probabilities fitted to what was learned
from; how many rules were found, and how many there are; CPU seconds of learning; and what `check` says.

FOLDER holds, for each domain, NAME.nid with the hidden rules, and where they were recorded elsewhere
NAME.train.jsonl.gz and NAME.test.jsonl.gz; else both are drawn, each from 200 random states of its own, as in
benchmarks/domains/hidden. By default the three small domains of tests/support/hidden_rules.py are hidden.
`--drawn` more transitions
(5,000) are drawn from the hidden rules, on walks of 12 actions from the states of the file that is learned
from, or from random ones. With `--flicker SHARE...` each fact after a transition that is learned from is seen
wrongly by each of these chances; TV and floor are by what is true. `--search tree pasula` has a row of each
search, and `--sizes` others than 100, 300 and 1,000 transitions.

About two minutes for seven domains, most of it for drawing. `--quick` takes five seconds.
"""

from __future__ import annotations

import argparse
import gzip
import itertools
import sys
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from cleancli.language.diagnostics.diagnostic import Source
from cleancli.language.load import checked_domain, load_domain, read_source
from cleancli.language.model import Domain, Outcome
from cleancli.language.printing.formatter import layout
from cleancli.language.printing.printer import print_domain
from cleancli.learning.drawn_states import drawn_states
from cleancli.learning.experience import Transition, decode
from cleancli.learning.learn import learn
from cleancli.learning.learn import revised as with_probabilities
from cleancli.learning.method import Method
from cleancli.learning.structure.arrays import compiled
from cleancli.learning.structure.induce import SEARCHES, TREE, revised
from cleancli.learning.variation import variation

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))
from support.hidden_rules import TEXTS, domain_of, starts
from support.walks import Start, flickering, walks

SIZES = (100, 300, 1000)
UNUSED = {"W201", "W202", "W203"}
"""Warnings of what a domain declares and no rule uses."""


@dataclass(frozen=True, slots=True)
class Hidden:
    """A domain with the rules that are to be found, transitions to learn from and to test by, and states to
    draw more from."""

    domain: Domain
    train: Sequence[Transition]
    test: Sequence[Transition]
    starts: Sequence[Start]


def of_folder(folder: Path, rng: np.random.Generator) -> Iterator[Hidden]:
    """The domains of a folder, in the order of their names."""
    for path in sorted(folder.glob("*.nid")):
        domain = load_domain(read_source(path))
        if not path.with_name(f"{path.stem}.train.jsonl.gz").exists():
            yield _drawn(domain, _starts(domain, rng), _starts(domain, rng), rng)
            continue
        train, test = (
            list(_read(path.with_name(f"{path.stem}.{part}.jsonl.gz"), domain)) for part in ("train", "test")
        )
        yield Hidden(domain, train, test, [(each.objects, each.before) for each in train])


def _starts(domain: Domain, rng: np.random.Generator) -> list[Start]:
    states = itertools.islice(drawn_states((domain,), rng), 200)
    return [(each.objects, each.before) for each in states]


def _drawn(
    domain: Domain, first: Sequence[Start], others: Sequence[Start], rng: np.random.Generator
) -> Hidden:
    """Transitions to learn from, and others of the test from other states."""
    train, test = (list(itertools.islice(walks(domain, each, rng), SIZES[-1])) for each in (first, others))
    return Hidden(domain, train, test[:300], first)


def _read(path: Path, domain: Domain) -> Iterator[Transition]:
    with gzip.open(path) as file:
        yield from decode(file, str(path), domain)  # type: ignore[arg-type]


def of_tests(rng: np.random.Generator) -> Iterator[Hidden]:
    """The small domains, with random transitions; those of the test are from other states."""
    for name in TEXTS:
        yield _drawn(domain_of(name), starts(name, rng), starts(name, rng), rng)


def without_rules(domain: Domain) -> Domain:
    """What is known before: the vocabulary."""
    return replace(domain, rules=(), default=(), parameters=(), learned=None)


def floor(domain: Domain, transitions: Sequence[Transition]) -> Domain:
    """The hidden rules, all of whose probabilities are those that make the transitions likeliest."""

    def free(outcomes: tuple[Outcome, ...]) -> tuple[Outcome, ...]:
        return tuple(replace(o, parameter=None, fixed=False, is_rest=False) for o in outcomes)

    rules = tuple(replace(rule, outcomes=free(rule.outcomes)) for rule in domain.rules)
    bare = replace(domain, rules=rules, parameters=(), learned=None)
    return with_probabilities(bare, learn(bare, transitions, Method("likelihood", 0.0, "shared", 0.0)))


def row(hidden: Hidden, transitions: Sequence[Transition], search: str) -> str:
    """A row of the table."""
    domain, bare = hidden.domain, without_rules(hidden.domain)
    began = time.process_time()
    actions = [action.name for action in bare.actions]
    found = revised(bare, compiled(bare, transitions), actions, search).domain
    seconds = time.process_time() - began
    text = layout(print_domain(found))
    codes = {each.code for each in checked_domain(Source("found", text)).diagnostics} - UNUSED
    off, least = (variation(domain, each, hidden.test) for each in (found, floor(domain, transitions)))
    rules = f"{len(found.rules)} ({len(domain.rules)})"
    told = f"{rules} | {search} | {seconds:.2f} | {', '.join(sorted(codes)) or 'nothing'}"
    return f"| {domain.name} | {len(transitions):,} | {off:.4f} | {least:.4f} | {told} |"


def main() -> None:
    """Print the table, row by row."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("folder", type=Path, nargs="?", metavar="FOLDER")
    parser.add_argument("--search", choices=SEARCHES, default=[TREE.search], nargs="+")
    parser.add_argument("--sizes", type=int, default=SIZES, nargs="+", help="at most 1,000 each")
    parser.add_argument("--seed", type=int, default=1, help="of the transitions that are drawn")
    parser.add_argument("--drawn", type=int, default=5000)
    parser.add_argument("--flicker", type=float, default=[0.0], nargs="+", metavar="SHARE")
    parser.add_argument("--quick", action="store_true")
    options = parser.parse_args()
    rng = np.random.default_rng(options.seed)
    every = of_tests(rng) if options.folder is None else of_folder(options.folder, rng)
    print("| domain | transitions | TV | floor | rules (hidden) | search | CPU s | check |")
    print("|---|---|---|---|---|---|---|---|", flush=True)
    for hidden, share in itertools.product(every, options.flicker):
        train = list(flickering(hidden.domain, hidden.train, share, rng)) if share else hidden.train
        sets = [train[:size] for size in options.sizes]
        if options.drawn and not options.quick:
            drawn = itertools.islice(walks(hidden.domain, hidden.starts, rng), options.drawn)
            sets.append(list(flickering(hidden.domain, drawn, share, rng)))
        for transitions, search in itertools.product(sets, options.search):
            print(row(hidden, transitions, search), flush=True)


if __name__ == "__main__":
    main()
