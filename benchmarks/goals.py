"""How often planners reach a goal, in closed loop: `python benchmarks/goals.py --planner prada+ ...`.

Four families of three sizes (goal_instances.py), in which nothing is paid but for the goal. A planner sees
the state, plans for the steps that are left, and its first action is done; an episode ends at the goal, where
the planner finds nothing worth doing, and with the last step. The n-th action of an episode meets the same
luck whichever planner chose it. Every episode has one of `POLICIES` seeds for its plans, and a state that an
episode with the same seed has met at the same step is not planned for again: so a planner is played as that
many policies, each in as many episodes.

Where the states are few enough for it, the optimum is told too. Each planner is compared with the first one
over the same episodes: differences by their standard errors, with Holm's correction for how many there are.

Samples are such that a plan takes some hundredths of a second. The whole takes about an hour of CPU, --quick
some seconds. With --keep each problem and planner is a line of FILE: what stands there is not played again.
"""

from __future__ import annotations

import argparse
import math
import statistics
import sys
import time
from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from goal_instances import GoalInstance, goal_instances
from kept import Kept
from scipy import stats
from written import planner_of

from cleancli.compiler.ground import ground
from cleancli.compiler.semantics import reaches_goal, successors
from cleancli.compiler.task import GroundAction, GroundState
from cleancli.planning.compiled_task import Prepared, prepare
from cleancli.planning.kernels.backward_induction import backward
from cleancli.planning.kernels.state_graph import Enumeration
from cleancli.planning.plan import Options, Plan
from cleancli.planning.planner import Planner

POLICIES = 10
"""Seeds of plans that a planner is played with. Chosen."""
SAMPLES = {"prada+": 1_000, "prada": 5_000, "uct": 2_000}
"""What planners are given that can take more: about as long for a plan."""
ROWS = ("prada+", "prada+:solve=0", "uct", "prada", "likeliest:width=200", "all-outcomes:width=200")
OPTIMUM_STATES, OPTIMUM_TRANSITIONS = 2_000_000, 20_000_000
"""Up to which the optimum is worked out: a gigabyte."""


@dataclass(frozen=True, slots=True)
class Result:
    """What came of a planner's episodes: which of them succeeded, how many plans there were, and the median
    and the 95th percentile of their CPU seconds."""

    planner: str
    family: str
    size: str
    succeeded: tuple[bool, ...]
    plans: int
    median: float
    most: float


class Player:
    """A planner with one seed, asked once for each state and number of steps left."""

    def __init__(self, prepared: Prepared, planner: Planner[Any], options: Options) -> None:
        self._prepared, self._planner, self._options = prepared, planner, options
        self._known: dict[tuple[GroundState, int], Plan] = {}
        self.seconds: list[float] = []

    def plan(self, state: GroundState, left: int, rest: tuple[GroundAction, ...]) -> Plan:
        """What to do; `rest` is what is left of the last plan."""
        if (state, left) not in self._known:
            begun = time.process_time()
            asked = replace(self._options, previous=rest)
            self._known[state, left] = self._planner(self._prepared.at(state, left), asked)
            self.seconds.append(time.process_time() - begun)
        return self._known[state, left]


def succeeds(prepared: Prepared, player: Player, luck: Sequence[float]) -> bool:
    """Whether an episode ends in the goal; there is a number in [0, 1) for each step."""
    task, rest = prepared.task, tuple[GroundAction, ...]()
    state, number = task.initial, {action: index for index, action in enumerate(task.actions)}
    for step, drawn in enumerate(luck):
        if reaches_goal(task, state):
            break
        plan = player.plan(state, task.horizon - step, rest)
        if not plan.actions:
            break
        after = successors(task, state, number[plan.actions[0]])
        reached = np.searchsorted(np.cumsum([chance for chance, _ in after]), drawn, side="right")
        state, rest = after[min(int(reached), len(after) - 1)][1], plan.actions[1:]
    return reaches_goal(task, state)


def played(name: str, instance: GoalInstance, prepared: Prepared, episodes: int, seed: int) -> Result:
    """A planner's episodes in a problem."""
    options = Options(samples=SAMPLES.get(name.partition(":")[0], 10_000), threads=1)
    settings = f"{name}{',' if ':' in name else ':'}margin=0.0" if "prada" in name else name
    planner, options = planner_of(settings, options)
    first = prepare(prepared.task)
    planner(first, replace(options, samples=1))  # loads what is compiled
    players = [
        Player(prepare(prepared.task), planner, replace(options, seed=1000 * seed + policy))
        for policy in range(min(POLICIES, episodes))
    ]
    luck = np.random.default_rng([seed, 3]).random((episodes, prepared.task.horizon))
    succeeded = tuple(
        succeeds(prepared, players[number % len(players)], drawn.tolist())
        for number, drawn in enumerate(luck)
    )
    seconds = [spent for player in players for spent in player.seconds]
    median, most = statistics.median(seconds), float(np.quantile(seconds, 0.95))
    return Result(name, instance.family, instance.size, succeeded, len(seconds), median, most)


def optimum(prepared: Prepared) -> float | None:
    """The greatest probability of the goal; None where there are too many states."""
    known, steps = prepared.forgetful, prepared.task.horizon
    enumeration = Enumeration(known.process, known.task.initial, OPTIMUM_STATES, edges=OPTIMUM_TRANSITIONS)
    if not enumeration.reach(steps):
        return None
    values, _ = backward(enumeration.graph(), known.process, 1.0, steps)
    return float(values[0, 0])


def share(succeeded: Sequence[bool]) -> str:
    """The share of successes, with its standard error."""
    mean = float(np.mean(succeeded))
    return f"{mean:.3f} ± {math.sqrt(mean * (1 - mean) / len(succeeded)):.3f}"


def difference(one: Sequence[bool], other: Sequence[bool]) -> tuple[float, float]:
    """By how much more often the first succeeds in the same episodes, and the probability of so great a
    difference, one way or the other, if there were none (McNemar's exact test)."""
    pairs = list(zip(one, other, strict=True))
    won, lost = sum(a and not b for a, b in pairs), sum(b and not a for a, b in pairs)
    chance = float(stats.binomtest(won, won + lost).pvalue) if won + lost else 1.0
    return (won - lost) / len(pairs), chance


def holm(chances: Sequence[float], level: float = 0.05) -> list[bool]:
    """Which of so many differences are significant together (Holm 1979)."""
    found = [False] * len(chances)
    for rank, place in enumerate(sorted(range(len(chances)), key=chances.__getitem__)):
        if chances[place] > level / (len(chances) - rank):
            break
        found[place] = True
    return found


def print_tables(results: Sequence[Result], optima: dict[tuple[str, str], float | None]) -> None:
    """A row for each problem and planner, and how the first planner compares with each other one."""
    print(
        "| problem | optimum | planner | success | plans | ms, median | 95 % |\n|---|---|---|---|---|---|---|"
    )
    for each in results:
        best = optima[each.family, each.size]
        known = "" if best is None else f"{best:.3f}"
        cells = [f"{each.family}, {each.size}", known, f"`{each.planner}`", share(each.succeeded)]
        print(f"| {' | '.join(cells)} | {each.plans} | {1e3 * each.median:.0f} | {1e3 * each.most:.0f} |")
    first = {(each.family, each.size): each for each in results if each.planner == results[0].planner}
    others = [each for each in results if each.planner != results[0].planner]
    compared = [difference(first[each.family, each.size].succeeded, each.succeeded) for each in others]
    significant = holm([chance for _, chance in compared])
    print(
        f"\n{len(compared)} comparisons with {results[0].planner}: worse and better, at 5 % each and by Holm"
    )
    for name in dict.fromkeys(each.planner for each in others):
        of = [(*compared[i], significant[i]) for i, each in enumerate(others) if each.planner == name]
        counts = (
            sum(way * gained > 0 and (surely if strict else chance < 0.05) for gained, chance, surely in of)
            for strict in (False, True)
            for way in (-1, 1)
        )
        print(name, *counts)


def main() -> None:
    """Play, and print a table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--seed", type=int, default=0, help="of the problems and the episodes")
    parser.add_argument("--planner", action="append", help="perhaps with options; default: all")
    parser.add_argument("--episodes", type=int, default=300)
    parser.add_argument(
        "--only", nargs="+", default=[""], help="problems whose names have one of these words"
    )
    parser.add_argument("--keep", type=Path, metavar="FILE", help="what was played before is in it")
    parser.add_argument("--quick", action="store_true", help="small problems, four episodes")
    given = parser.parse_args()
    instances = [
        each
        for each in goal_instances(given.seed)
        if any(word in f"{each.family}, {each.size}" for word in given.only)
        and not (given.quick and each.size != "small")
    ]
    episodes, kept = 4 if given.quick else given.episodes, Kept(given.keep)
    known = {(*row["asked"],): row["result"] for row in kept.rows()}
    results, optima = list[Result](), dict[tuple[str, str], float | None]()
    for instance in instances:
        prepared = prepare(ground(instance.domain, instance.problem))
        optima[instance.family, instance.size] = optimum(prepared)
        for name in given.planner or ROWS:
            asked = (name, instance.family, instance.size, episodes, given.seed)
            if asked not in known:
                known[asked] = asdict(played(name, instance, prepared, episodes, given.seed))
                kept.add({"asked": asked, "result": known[asked]})
            result = Result(**known[asked] | {"succeeded": tuple(known[asked]["succeeded"])})
            print(instance.family, instance.size, name, share(result.succeeded), file=sys.stderr, flush=True)
            results.append(result)
    print_tables(results, optima)


if __name__ == "__main__":
    main()
