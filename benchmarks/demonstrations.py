"""A pupil beside who knows the rules: python benchmarks/demonstrations.py [FOLDER] [--seeds N] [--seed N]

A pupil knows a vocabulary alone. It plans by the rules that it learns, and asks a teacher where no plan is
believed to reach the goal (`execute --strategy explore --learn --teacher FILE`). It has ten episodes, each in
a problem of its own. Who knows the hidden rules plans in the same problems, with the same luck. Told is in
which share of the episodes either reaches the goal, how many demonstrations the pupil had in all its
episodes, and how many of one action at most: the mean over the seeds and the most.

A goal is a fact that a walk of random actions has made true, so that it can be reached; some need a dozen
actions, and dead ends may come first. `pupil as far` is the share of those successes that the pupil has,
in the last five episodes, with an interval of 95 % (bootstrap over the seeds).

benchmarks/domains/glasses.nid needs no file. FOLDER holds tireworld and responders, as for exploration.py.

With ten seeds half a minute of CPU time for each domain. `--quick` takes ten seconds.
"""

from __future__ import annotations

import itertools
import statistics
import sys
import time
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from pathlib import Path

import numpy as np
from exploration import Hidden, asked, facts_of
from whole_rules import without_rules

from cleancli.compiler.fluents import Fluent
from cleancli.execution.events import Acted, Decided, Ended
from cleancli.execution.loop import clean
from cleancli.execution.session import symbolic_session
from cleancli.execution.setup import EpisodeOptions
from cleancli.execution.teaching import of_rules
from cleancli.language.model import Domain, Horizon, Literal, Problem, RewardKind, RewardTerm
from cleancli.learning.experience import Transition
from cleancli.learning.method import DEFAULT, KNOWN

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))
from support.walks import Start, walks

EPISODES, LATE = 10, 5
WALK, WALKS, MOST_ACTIONS, HORIZON = 12, 20, 25, 12
SAMPLES = 200
RESAMPLED = 2000


def with_goal(hidden: Domain, start: Start, rng: np.random.Generator) -> Problem | None:
    """From a start, the problem to make a fact true that a walk of random actions makes true; None where no
    walk does."""
    for _ in range(WALKS):
        steps = walks(hidden, [start], rng, steps=WALK)
        *_, last = itertools.islice(steps, WALK)
        new = sorted(key for key, value in last.after.items() if value is True and key not in start[1])
        if new:
            return _problem(hidden, start, new[int(rng.integers(len(new)))])
    return None


def _problem(hidden: Domain, start: Start, wanted: Fluent) -> Problem:
    objects, values = start
    types = {each.name: each for each in (*hidden.constants, *objects)}
    goal = Literal(wanted[0], tuple(types[name] for name in wanted[1]), frozenset({True}))
    return Problem("here", hidden.name, objects, facts_of(values), Horizon(HORIZON), goal=(goal,))


@dataclass(frozen=True, slots=True)
class Episode:
    """Whether the goal was reached, what was done, and the actions that a teacher has shown."""

    success: bool
    done: tuple[Transition, ...]
    shown: tuple[str, ...]


def played(
    domain: Domain, hidden: Domain, problem: Problem, options: EpisodeOptions, seen: Sequence[Transition]
) -> Episode:
    """One episode, in which a pupil has seen so much before."""
    session = symbolic_session(domain, problem, options, acting=hidden)
    setup = replace(session.setup, experience=tuple(seen))
    teacher = of_rules(hidden, SAMPLES) if options.is_taught else None
    success, done, shown = False, list[Transition](), list[str]()
    for event in clean(setup, session.cell, teacher=teacher):
        match event:
            case Decided(is_taught=True):
                shown += (move.action for move in event.moves)
            case Acted(transition=Transition() as transition):
                done.append(transition)
            case Ended():
                success = event.clean
    return Episode(success, tuple(done), tuple(shown))


def pupil_and_other(hidden: Hidden, seed: int) -> tuple[list[Episode], list[Episode]]:
    """The pupil's episodes, and in the same problems those of who knows the rules."""
    rng = np.random.default_rng(seed)
    true = replace(hidden.domain, reward=(RewardTerm(Fraction(1), RewardKind.GOAL),))
    knowing = EpisodeOptions("plan-1", samples=SAMPLES, max_actions=MOST_ACTIONS)
    learning = replace(
        knowing, strategy="explore", learning=DEFAULT, known=KNOWN, structure=True, is_taught=True
    )
    bare, seen = without_rules(true), list[Transition]()
    pupil, other = list[Episode](), list[Episode]()
    starts = (hidden.starts[number] for number in rng.permutation(len(hidden.starts)))
    problems = (problem for start in starts if (problem := with_goal(true, start, rng)) is not None)
    for number, problem in enumerate(itertools.islice(problems, EPISODES)):
        own = seed * EPISODES + number
        pupil.append(played(bare, true, problem, replace(learning, seed=own), seen))
        other.append(played(true, true, problem, replace(knowing, seed=own), ()))
        seen += pupil[-1].done
    return pupil, other


def row(hidden: Hidden, seeds: Sequence[int]) -> str:
    """A row of the table."""
    began = time.process_time()
    runs = []
    for seed in seeds:
        runs.append(pupil_and_other(hidden, seed))
        pupil, other = ("".join("+" if each.success else "-" for each in side) for side in runs[-1])
        print(f"{hidden.domain.name} {seed}: {pupil}, knowing {other}", file=sys.stderr)
    shown = [Counter(name for each in run[0] for name in each.shown) for run in runs]
    totals, most = [each.total() for each in shown], [max(each.values(), default=0) for each in shown]
    successes = np.array([[[each.success for each in side] for side in run] for run in runs], dtype=float)
    late = successes[:, :, -LATE:].sum(axis=2)
    drawn = np.random.default_rng(0).integers(len(runs), size=(RESAMPLED, len(runs)))
    ratios = late[drawn, 0].sum(axis=1) / np.maximum(late[drawn, 1].sum(axis=1), 1)
    low, high = np.quantile(ratios, (0.025, 0.975))
    share = late[:, 0].sum() / max(late[:, 1].sum(), 1)
    early = f"{successes[:, 0, :LATE].mean():.2f} ({successes[:, 1, :LATE].mean():.2f})"
    told = f"{successes[:, 0, -LATE:].mean():.2f} ({successes[:, 1, -LATE:].mean():.2f})"
    return (
        f"| {hidden.domain.name} | {early} | {told} | {share:.2f} ({low:.2f} to {high:.2f})"
        f" | {statistics.mean(totals):.1f} ({max(totals)}) | {statistics.mean(most):.1f} ({max(most)})"
        f" | {len(hidden.domain.actions)} | {time.process_time() - began:.0f} |"
    )


def main() -> None:
    """Print the table, row by row."""
    options, seeds, every = asked(__doc__, "two seeds in glasses")
    heads = ("domain", "episodes 1 to 5: pupil (knowing)", "6 to 10", "pupil as far", "demonstrations (most)")
    print(f"| {' | '.join((*heads, 'of one action (most)', 'actions', 'CPU s'))} |")
    print("|---|---|---|---|---|---|---|---|", flush=True)
    for name, hidden in every.items():
        if options.domain in (None, name):
            print(row(hidden, seeds), flush=True)


if __name__ == "__main__":
    main()
