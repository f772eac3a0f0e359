"""How near planners come to the optimum, in closed loop: `python benchmarks/regret.py --planner prada ...`.

Random problems (instances.py) with at most 5,000 states that can be reached within their steps; with --large
those of large_instances.py, with 10,000 to 500,000. At step t of H a planner sees the state, plans for H - t
steps, and its first action is done. A planner's share is what it gains over doing nothing, as part of what
the optimum gains; problems where that is less than `WORTH` say nothing and are skipped. Plans count where
they are worth any more than doing nothing (`margin` is 0).

A planner with a fixed seed is a policy. Where it meets few pairs of state and step, its return is exact: the
optimum less what each of its actions loses against the optimum, weighted by the probability that the pair
comes. Else the same losses are summed over drawn episodes, on the same draws for all planners: with the
optimal values as control variate, only the losses are noisy, and an optimal planner has no error at all.

With --large what has lost its meaning for good is forgotten for all planners, which changes no value and
leaves fewer states. Shares are all from drawn episodes, and the first planner is compared with each of the
others, episode by episode on the same draws: a problem in which its share is less by more than twice the
standard error of the difference is counted as lost. A planner's first plan of a problem may take longer than
those that come after it, so the most that any took is told, too.

200 problems take about ten minutes of CPU for each of the quick planners, and hours for `uct` and others that
are given a time limit. It says which problem is done, and with --keep each is a line of FILE: those that
stand there are not played again. The 60 large problems take half an hour with all planners.
"""

from __future__ import annotations

import argparse
import json
import math
import multiprocessing
import sys
import time
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from instances import instance
from kept import Kept
from large_instances import large_instance
from written import planner_of

from cleancli.compiler.ground import ground
from cleancli.compiler.semantics import idle_worth
from cleancli.compiler.task import GroundAction
from cleancli.planning.compiled_task import Prepared, prepare
from cleancli.planning.kernels.backward_induction import backward
from cleancli.planning.kernels.state_graph import Graph, reachable
from cleancli.planning.plan import Options
from cleancli.planning.planner import Planner, Plans
from cleancli.planning.registry import PLANNERS

STATES = 5_000
LARGE_STATES = (10_000, 500_000)
WORTH = 0.2
"""What the optimum must gain over doing nothing for a problem to count. Chosen."""
ANYTIME = {"uct": 10_000_000, "prada+": 10_000_000}
"""Planners that go on until their time is over, and the samples that they are allowed."""
ROWS = (*PLANNERS, "prada+:solve=0", "prada+:solve=0,runs=0")
LARGE_ROWS = tuple(name for name in ROWS if name not in ("exact", "aprada"))
"""What is played where no planner is asked for (docs/measurements/planning.md). Large problems are solved to
know the optimum anyway, and `aprada` differs little from `prada`."""
FEWER = {"uct": 30}
"""Planners that play the first so many problems alone, unless they are asked for: they need hours
otherwise."""


@dataclass(frozen=True, slots=True)
class Asked:
    """`planners` by name, perhaps with options: `prada+:solve=0`. `pairs` of state and step at most for an
    exact return, else so many `episodes`; `time_limit` in seconds for a plan of an anytime planner; whether
    problems are `large`."""

    planners: tuple[str, ...]
    pairs: int
    episodes: int
    time_limit: float
    samples: int
    large: bool = False


@dataclass(frozen=True, slots=True)
class Game:
    """A problem with its optimum: `values` (H + 1, N) by step and state; `idle` (H + 1,) is what a reward of
    1 in each step that is left after so many is worth."""

    prepared: Prepared
    graph: Graph
    values: np.ndarray
    idle: np.ndarray

    @property
    def steps(self) -> int:
        return len(self.values) - 1

    def nothing(self, step: int, state: int) -> float:
        """What it is worth to do nothing from there on."""
        return float(self.idle[step] * self.graph.standing[state])

    def choice(self, state: int, action: int) -> int | None:
        """The number of a choice in the graph; None where the action changes nothing."""
        first, last = self.graph.choice_start[state : state + 2].tolist()
        place = first + int(np.searchsorted(self.graph.choice_action[first:last], action))
        return place if place < last and self.graph.choice_action[place] == action else None


@dataclass(frozen=True, slots=True)
class Score:
    """A planner's share in a problem, its standard error (0 where exact), seconds per plan, and the share
    that each drawn episode lost."""

    planner: str
    family: str
    seed: int
    share: float
    error: float
    seconds: tuple[float, ...]
    lost: tuple[float, ...] = ()


def game_of(prepared: Prepared, steps: int, states: int = STATES) -> Game | None:
    """The optimum of a task; None where it has more states."""
    task, process = prepared.task, prepared.process
    graph = reachable(process, task.initial, states, steps)
    if graph is None:
        return None
    values, _ = backward(graph, process, task.discount, steps)
    return Game(prepared, graph, values, idle_worth(task.discount, steps)[::-1])


class Policy:
    """A planner's first actions by step and state, asked for when first wanted."""

    def __init__(self, game: Game, planner: Plans, options: Options) -> None:
        self._game, self._planner, self._options = game, planner, options
        actions = game.prepared.task.actions
        self._number: dict[GroundAction, int] = {action: index for index, action in enumerate(actions)}
        self._known: dict[tuple[int, int], int | None] = {}
        self.seconds: list[float] = []

    def __len__(self) -> int:
        return len(self._known)

    def action(self, step: int, state: int) -> int | None:
        """The action's index; None to do nothing from here on."""
        if (step, state) not in self._known:
            row = tuple(self._game.graph.states[state].tolist())
            started = time.perf_counter()
            plan = self._planner(self._game.prepared.at(row, self._game.steps - step), self._options)
            self.seconds.append(time.perf_counter() - started - plan.seconds.get("compile", 0.0))
            self._known[step, state] = self._number[plan.actions[0]] if plan.actions else None
        return self._known[step, state]


@dataclass(frozen=True, slots=True)
class Move:
    """What an action loses against the optimum, the states it may lead to with their probabilities, and its
    discount; nowhere, where nothing is done from there on."""

    loss: float
    after: tuple[tuple[int, float], ...]
    discount: float


def move(game: Game, step: int, state: int, action: int | None) -> Move:
    """What comes of an action in a state at a step."""
    best, graph, process = game.values[step, state], game.graph, game.prepared.process
    if action is None:
        return Move(best - game.nothing(step, state), (), 0.0)
    choice = game.choice(state, action)
    after: tuple[tuple[int, float], ...] = ((state, 1.0),)
    reward = graph.standing[state] - process.cost[action]
    if choice is not None:
        edges = slice(graph.edge_start[choice], graph.edge_start[choice + 1])
        successors, chances = graph.edge_successor[edges].tolist(), graph.edge_probability[edges].tolist()
        reward, after = graph.choice_reward[choice], tuple(zip(successors, chances, strict=True))
    discount = float(process.discount[action])
    expected = sum(p * game.values[step + 1, s] for s, p in after)
    return Move(best - process.payment[action] * reward - discount * expected, after, discount)


def exact_loss(game: Game, policy: Policy, pairs: int) -> float | None:
    """What a policy loses against the optimum; None where it meets more pairs of state and step."""
    weights, total = {0: 1.0}, 0.0
    for step in range(game.steps):
        if len(policy) + len(weights) > pairs:
            return None
        later: dict[int, float] = {}
        for state, weight in sorted(weights.items()):
            moved = move(game, step, state, policy.action(step, state))
            total += weight * moved.loss
            for after, chance in moved.after:
                later[after] = later.get(after, 0.0) + weight * chance * moved.discount
        weights = later
    return total


def drawn_loss(game: Game, policy: Policy, episodes: int, seed: int) -> list[float]:
    """What a policy loses against the optimum in each of so many drawn episodes."""
    losses = []
    for luck in np.random.default_rng(seed).random((episodes, game.steps)):
        state, weight, total = 0, 1.0, 0.0
        for step in range(game.steps):
            moved = move(game, step, state, policy.action(step, state))
            total += weight * moved.loss
            if not moved.after:
                break
            reached = np.searchsorted(np.cumsum([p for _, p in moved.after]), luck[step], side="right")
            state = moved.after[min(int(reached), len(moved.after) - 1)][0]
            weight *= moved.discount
        losses.append(float(total))
    return losses


def mean_of(values: Sequence[float]) -> tuple[float, float]:
    """A mean and its standard error."""
    return float(np.mean(values)), float(np.std(values, ddof=1) / math.sqrt(len(values)))


def player_of(text: str, asked: Asked, seed: int) -> tuple[Planner[Any], Options]:
    """The planner of a text like `uct:exploration=1`, with the options of this comparison. Raises as
    `planner_of` does."""
    name, margin = text.partition(":")[0], "margin=0.0" if "prada" in text else ""
    options = Options(samples=asked.samples, seed=seed, threads=1)
    if name in ANYTIME:
        options = replace(options, samples=ANYTIME[name], time_limit=asked.time_limit)
    return planner_of(f"{name}:{margin},{text.partition(':')[2]}", options)


def scores(seed: int, asked: Asked) -> tuple[Score, ...] | str:
    """Of each planner on the problem of a seed, or why there are none."""
    found = large_instance(seed) if asked.large else instance(seed)
    fewest, most = LARGE_STATES if asked.large else (0, STATES)
    prepared = prepare(ground(found.domain, found.problem))
    game = game_of(prepared.forgetful if asked.large else prepared, found.steps, most)
    if game is None:
        return f"more than {most:,} states"
    if len(game.graph.states) < fewest:
        return f"fewer than {fewest:,} states"
    worth = float(game.values[0, 0] - game.nothing(0, 0))
    if worth < WORTH:
        return f"the optimum gains less than {WORTH}"
    return tuple(score(name, game, found.family, seed, worth, asked) for name in asked.planners)


def score(name: str, game: Game, family: str, seed: int, worth: float, asked: Asked) -> Score:
    """Of a planner on a problem; `worth` is what the optimum gains."""
    policy = Policy(game, *player_of(name, asked, seed))
    loss = None if asked.large else exact_loss(game, policy, asked.pairs)
    if loss is not None:
        return Score(name, family, seed, 1 - loss / worth, 0.0, tuple(policy.seconds))
    lost = tuple(each / worth for each in drawn_loss(game, policy, asked.episodes, seed))
    share, error = mean_of(lost)
    return Score(name, family, seed, 1 - share, error, tuple(policy.seconds), lost)


def print_table(found: Sequence[Score]) -> None:
    width = max(len(score.planner) for score in found)
    print(
        f"{'planner':{width}} problems   mean  worst     5%  >=0.95  >=0.99  s/step     95%    most   error"
    )
    for name in dict.fromkeys(score.planner for score in found):
        mine = [score for score in found if score.planner == name]
        shares = np.array([score.share for score in mine])
        low = np.quantile(shares, 0.05)
        seconds = [spent for score in mine for spent in score.seconds]
        error = math.sqrt(sum(score.error**2 for score in mine)) / len(mine)
        print(
            f"{name:{width}} {len(mine):8} {shares.mean():6.3f} {shares.min():6.3f} {low:6.3f}"
            f" {np.mean(shares >= 0.95):7.2f} {np.mean(shares >= 0.99):7.2f}"
            f" {np.median(seconds):7.4f} {np.quantile(seconds, 0.95):7.4f} {max(seconds):7.3f} {error:6.4f}"
        )
    print("\nmean share by family, and the worst problems")
    for name in dict.fromkeys(score.planner for score in found):
        means = {
            family: [score.share for score in found if (score.planner, score.family) == (name, family)]
            for family in sorted({score.family for score in found})
        }
        shown = (f"{family} {np.mean(shares):.3f}" for family, shares in means.items() if shares)
        mine = sorted((score for score in found if score.planner == name), key=lambda score: score.share)
        worst = ", ".join(f"{score.family} {score.seed}: {score.share:.3f}" for score in mine[:3])
        print(f"{name:{width}} {'  '.join(shown)}\n{'':{width}} worst: {worst}")


def print_comparison(found: Sequence[Score]) -> None:
    """In how many problems the first planner is seen to lose against each other one, and to win."""
    first = {score.seed: score for score in found if score.planner == found[0].planner}
    print(f"\nproblems in which {found[0].planner} is significantly worse and better than")
    for name in dict.fromkeys(score.planner for score in found[1:] if score.planner != found[0].planner):
        worse = better = 0
        for score in (score for score in found if score.planner == name):
            mean, error = mean_of(np.subtract(first[score.seed].lost, score.lost).tolist())
            worse += mean > 2 * error + 1e-9
            better += -mean > 2 * error + 1e-9
        print(f"{name:24} {worse:4} {better:4}")


def played(seeds: Sequence[int], asked: Asked, jobs: int, kept: Kept) -> Iterator[tuple[Score, ...] | str]:
    """The scores of all seeds, in their order; those that are kept are not played again."""
    what = json.loads(json.dumps(asdict(asked)))
    known = {row["seed"]: row["result"] for row in kept.rows() if row["asked"] == what}
    fresh = in_turn([seed for seed in seeds if seed not in known], asked, jobs)
    for seed in seeds:
        if seed not in known:
            known[seed] = next(fresh)
            kept.add({"asked": what, "seed": seed, "result": known[seed]})
        result = known[seed]
        said = "skipped" if isinstance(result, str) else f"{len(result)} planners"
        print(f"problem {seed}: {said}", file=sys.stderr, flush=True)
        yield result if isinstance(result, str) else tuple(Score(**score) for score in result)


def in_turn(seeds: Sequence[int], asked: Asked, jobs: int) -> Iterator[list[dict[str, Any]] | str]:
    """The scores of each seed as data, as soon as they are known."""
    if jobs == 1:
        yield from (as_data(scores(seed, asked)) for seed in seeds)
        return
    with ProcessPoolExecutor(jobs, multiprocessing.get_context("spawn")) as executor:
        yield from map(as_data, executor.map(scores, seeds, [asked] * len(seeds)))


def as_data(result: tuple[Score, ...] | str) -> list[dict[str, Any]] | str:
    """What a file can keep."""
    if isinstance(result, str):
        return result
    return [asdict(score) | {"share": float(score.share), "error": float(score.error)} for score in result]


def wanted_scores(
    wanted: int, first: int, asked: Asked, jobs: int, kept: Kept
) -> tuple[list[tuple[Score, ...]], Mapping[str, int]]:
    """The scores of so many problems, and how many were skipped on the way, by reason."""
    counted: list[tuple[Score, ...]] = []
    skipped: dict[str, int] = {}
    while len(counted) < wanted:
        batch = range(first, first + wanted - len(counted))
        first = batch.stop
        for result in played(batch, asked, jobs, kept):
            if isinstance(result, str):
                skipped[result] = skipped.get(result, 0) + 1
            else:
                counted.append(result)
    return counted, skipped


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--seed", type=int, default=0, help="of the first problem")
    parser.add_argument(
        "--problems", type=int, help="that count (200, large ones 60), of the seeds they need"
    )
    parser.add_argument(
        "--planner", action="append", help="perhaps with options, like prada+:solve=0; default: all"
    )
    parser.add_argument("--keep", type=Path, metavar="FILE", help="problems played before are in it")
    parser.add_argument("--pairs", type=int, default=60)
    parser.add_argument("--episodes", type=int, default=20)
    parser.add_argument("--time-limit", type=float, default=0.1)
    parser.add_argument("--samples", type=int, default=10_000)
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--large", action="store_true", help="problems of 10,000 to 500,000 states")
    parser.add_argument("--quick", action="store_true", help="few problems, few samples")
    given = parser.parse_args()
    rows = LARGE_ROWS if given.large else [name for name in ROWS if name not in FEWER]
    planners = tuple(dict.fromkeys(given.planner or rows))
    asked = Asked(planners, given.pairs, given.episodes, given.time_limit, given.samples, given.large)
    wanted = given.problems or (60 if given.large else 200)
    if given.quick:
        asked = replace(asked, samples=500, time_limit=0.01, pairs=30, episodes=3 if given.large else 8)
        wanted = 2 if given.large else 8
    kept = Kept(given.keep)
    counted, skipped = wanted_scores(wanted, given.seed, asked, given.jobs, kept)
    for name, most in {} if given.planner or given.large else FEWER.items():
        one = replace(asked, planners=(name,))
        counted += wanted_scores(min(most, wanted), given.seed, one, given.jobs, kept)[0]
    found = [score for result in counted for score in result]
    print_table(found)
    if given.large:
        print_comparison(found)
    reasons = ", ".join(f"{number} where {reason}" for reason, number in skipped.items())
    print(f"\n{wanted} problems; skipped: {reasons or 'none'}")


if __name__ == "__main__":
    main()
