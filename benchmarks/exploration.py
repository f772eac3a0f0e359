"""Exploration beside random actions: python benchmarks/exploration.py [FOLDER] [--seeds N] [--seed N]

From a vocabulary alone, rules are learned from what is tried (`execute --strategy explore --learn`), and from
as many actions drawn at random. Told is how far what the learned rules foretell for held-out pairs of a state
and an action is from what the hidden rules do (total variation, in the mean): the median over the seeds, and
the greatest; then with what chance the differences, seed by seed, would lean so far by chance alone
(Wilcoxon's signed-rank test).

An episode begins in a problem of its own and takes at most 12 actions. It ends sooner where the explorer sees
nothing to try that it can reach; where that is so at the beginning of an episode, what it takes to be known
rises by a quarter. Random actions are drawn uniformly, then their arguments from all that there are. They
have episodes of 12 actions, and in another column as many beginnings as the explorer had.

FOLDER holds tireworld and responders, each as NAME.nid with the hidden rules, NAME.train.jsonl.gz, of which
each twelfth state begins an episode, and NAME.test.jsonl.gz, the pairs. benchmarks/domains/glasses.nid, which
has dead ends, begins in states that are drawn, and needs no file; so it is all that is tried without FOLDER.

With ten seeds about a minute of CPU time for tireworld, two for glasses, and eight for responders. `--quick`
takes five seconds.
"""

from __future__ import annotations

import argparse
import itertools
import statistics
import sys
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from cleancli.compiler.fluents import Fluent, Values
from cleancli.compiler.lifted_state import LiftedRules
from cleancli.language.load import load_domain, read_source
from cleancli.language.model import Domain, Fact, Object, Problem, Value
from cleancli.learning.experience import Transition
from cleancli.learning.exploration.explored import explored
from cleancli.learning.exploration.seeking import next_try
from cleancli.learning.exploration.worth import arguments_of
from cleancli.learning.method import KNOWN
from cleancli.learning.structure.arrays import compiled
from cleancli.learning.structure.induce import revised
from cleancli.learning.variation import variation
from cleancli.planning.plan import Options
from cleancli.planning.registry import PLANNERS
from cleancli.statistics.paired import signed_rank

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))
from whole_rules import of_folder, without_rules

from support.walks import Start, drawn_after, walks

GLASSES = Path(__file__).parent / "domains" / "glasses.nid"
ACTIONS = {"tireworld": 300, "responders": 1000, "glasses": 500}
"""Of each domain, as many as it is to be known by."""
STEPS, STARTS, PAIRS = 12, 60, 300
RISE = 1.25
SAMPLES = 300


@dataclass(frozen=True, slots=True)
class Hidden:
    """A domain whose rules are to be found, states in which episodes begin, and pairs to test by."""

    domain: Domain
    starts: Sequence[Start]
    test: Sequence[Transition]


def of_files(folder: Path, seed: int) -> dict[str, Hidden]:
    """The domains of a folder that are tried."""
    every = of_folder(folder, np.random.default_rng(seed))
    found = {each.domain.name: each for each in every if each.domain.name in ACTIONS}
    return {name: Hidden(each.domain, each.starts[::STEPS], each.test) for name, each in found.items()}


def glasses(seed: int) -> Hidden:
    """Glasses on icy floors, and pairs from walks in other states than those in which episodes begin."""
    domain, rng = load_domain(read_source(GLASSES)), np.random.default_rng(seed)
    test = itertools.islice(walks(domain, [_floor(rng) for _ in range(STARTS)], rng), PAIRS)
    return Hidden(domain, [_floor(rng) for _ in range(STARTS)], list(test))


def _floor(rng: np.random.Generator) -> Start:
    places = [f"p{number}" for number in range(1, int(rng.integers(4, 7)))]
    things = [f"g{number}" for number in range(1, int(rng.integers(3, 5)))]
    values: dict[Fluent, Value] = {("robot_at", (str(rng.choice(places)),)): True}
    values |= {("glass_at", (thing, str(rng.choice(places)))): True for thing in things}
    values |= {("icy", (place,)): True for place in places if rng.random() < 0.3}
    values |= {("broken", (thing,)): True for thing in things if rng.random() < 0.2}
    pairs = itertools.permutations(places, 2)
    values |= {("beside", pair): True for pair in pairs if rng.random() < 0.5}
    objects = (*(Object(p, "place") for p in places), *(Object(t, "glass") for t in things))
    return objects, values


@dataclass(frozen=True, slots=True)
class Explored:
    """What was tried in how many episodes, and in how many CPU seconds."""

    transitions: tuple[Transition, ...]
    episodes: int
    seconds: float


def explorer(hidden: Hidden, seed: int, actions: int) -> Explored:
    """Episodes of the explorer until so many actions are done."""
    rng, began = np.random.default_rng(seed), time.process_time()
    order, world = rng.permutation(len(hidden.starts)), LiftedRules(hidden.domain)
    found, known, done = explored(without_rules(hidden.domain), []), float(KNOWN), list[Transition]()
    episodes, planner = 0, PLANNERS["prada+"]
    while len(done) < actions:
        objects, values = hidden.starts[order[episodes % len(order)]]
        episodes += 1
        for step in range(min(STEPS, actions - len(done))):
            problem = Problem("here", hidden.domain.name, objects, facts_of(values))
            asked = Options(SAMPLES, int(rng.integers(2**63)), threads=1)
            chosen = next_try(found, problem, round(known), planner, asked)
            if chosen is None:
                known *= RISE if step == 0 else 1
                break
            after = drawn_after(hidden.domain, world, objects, values, chosen.action, chosen.objects, rng)
            done.append(Transition(chosen.action, chosen.objects, objects, values, after))
            found, values = explored(without_rules(hidden.domain), done, found), after
    return Explored(tuple(done), episodes, time.process_time() - began)


def at_random(hidden: Hidden, seed: int, actions: int, episodes: int) -> list[Transition]:
    """As many actions, drawn at random, in so many episodes."""
    rng = np.random.default_rng(seed)
    order, world = rng.permutation(len(hidden.starts)), LiftedRules(hidden.domain)
    ends = {round(actions * (number + 1) / episodes) for number in range(episodes)}
    done: list[Transition] = []
    begun = 0
    objects, values = hidden.starts[order[0]]
    while len(done) < actions:
        action = hidden.domain.actions[int(rng.integers(len(hidden.domain.actions)))]
        arguments = arguments_of(hidden.domain, action, objects, rng)
        if arguments:
            names = arguments[int(rng.integers(len(arguments)))]
            after = drawn_after(hidden.domain, world, objects, values, action.name, names, rng)
            done.append(Transition(action.name, names, objects, values, after))
            values = after
        if not arguments or len(done) in ends:
            begun += 1
            objects, values = hidden.starts[order[begun % len(order)]]
    return done


def facts_of(values: Values) -> frozenset[Fact]:
    """The facts of a state."""
    return frozenset(
        Fact(name, names, value) for (name, names), value in values.items() if value is not False
    )


def off(hidden: Hidden, transitions: Sequence[Transition]) -> float:
    """How far what rules from these transitions foretell is from what is true."""
    bare = without_rules(hidden.domain)
    actions = [action.name for action in bare.actions]
    return variation(hidden.domain, revised(bare, compiled(bare, transitions), actions).domain, hidden.test)


def row(hidden: Hidden, seeds: Sequence[int], actions: int) -> str:
    """A row of the table."""
    tried, drawn, beginnings = list[float](), list[float](), list[float]()
    episodes, seconds = list[int](), list[float]()
    for seed in seeds:
        found = explorer(hidden, seed, actions)
        tried.append(off(hidden, found.transitions))
        drawn.append(off(hidden, at_random(hidden, seed, actions, -(-actions // STEPS))))
        beginnings.append(off(hidden, at_random(hidden, seed, actions, found.episodes)))
        episodes.append(found.episodes)
        seconds.append(found.seconds)
        told = f"{tried[-1]:.4f}, random {drawn[-1]:.4f}, as many beginnings {beginnings[-1]:.4f}"
        print(f"{hidden.domain.name} {seed}: {told}; {seconds[-1]:.1f} CPU s", file=sys.stderr)
    chances = (signed_rank(np.array(each) - np.array(tried)) for each in (drawn, beginnings))
    off_by = [f"{statistics.median(each):.4f} ({max(each):.3f})" for each in (tried, drawn, beginnings)]
    first, second = (f"{chance:.4f}" for chance in chances)
    return (
        f"| {hidden.domain.name} | {actions:,} | {off_by[0]} | {off_by[1]} | {first} | {off_by[2]} | {second}"
        f" | {statistics.median(episodes):g} | {statistics.median(seconds):.1f} |"
    )


def asked(description: str | None, quick: str) -> tuple[argparse.Namespace, Sequence[int], dict[str, Hidden]]:
    """The options of a benchmark that is tried by several seeds in these domains, the seeds, and the domains;
    `quick` says what it does then."""
    parser = argparse.ArgumentParser(
        description=description, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("folder", type=Path, nargs="?", metavar="FOLDER")
    parser.add_argument("--domain", choices=list(ACTIONS), help="this one alone")
    parser.add_argument("--seeds", type=int, default=10)
    parser.add_argument("--seed", type=int, default=1, help="the first of them, and that of drawn states")
    parser.add_argument("--quick", action="store_true", help=quick)
    options = parser.parse_args()
    seeds = range(options.seed, options.seed + (2 if options.quick else options.seeds))
    every = {} if options.folder is None or options.quick else of_files(options.folder, options.seed)
    every["glasses"] = glasses(options.seed)
    return options, seeds, every


def main() -> None:
    """Print the table, row by row."""
    options, seeds, every = asked(__doc__, "60 actions by two seeds in glasses")
    heads = (
        "domain",
        "actions",
        "explored: TV (greatest)",
        "random",
        "p",
        "as many beginnings",
        "p",
        "episodes",
    )
    print(f"| {' | '.join((*heads, 'CPU s'))} |")
    print("|---|---|---|---|---|---|---|---|---|", flush=True)
    for name, hidden in every.items():
        if options.domain in (None, name):
            print(row(hidden, seeds, 60 if options.quick else ACTIONS[name]), flush=True)


if __name__ == "__main__":
    main()
