"""PRADA+: what PRADA finds, improved by annealing over rollouts; small problems are solved exactly.

PRADA values a sequence by a belief whose variables are independent, and only ever draws new sequences. Here a
sequence is valued by runs of the process itself, and the next one to try is a change of a good one. Where few
states can be reached, no sequence is sought: the best policy is calculated (docs/decisions/0008).
"""

from __future__ import annotations

import itertools
import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace

from cleancli.planning import kernels
from cleancli.planning.compiled_task import Prepared
from cleancli.planning.plan import Options, Plan, option
from cleancli.planning.planners import exact, policy_search, reaching, solving
from cleancli.planning.planners.prada import PradaOptions, prada
from cleancli.planning.policy import Course, Policy
from cleancli.planning.preference import preferred
from cleancli.planning.trajectory import beats_nothing, course_plan

CHAINS = 4
"""Annealings, each over runs of its own: what one overrates, the others do not. Chosen."""

BELIEF_SHARE = 20
"""PRADA draws one sequence for so many that are tried. Chosen."""

FIRST_MOVES = 500
"""Changes that the first chains try where time is limited. Chosen: milliseconds for ten areas."""

DESCENT_SHARE = 4
"""The tree is searched by one descent for so many samples. Chosen: about as long as annealing takes."""

SEQUENCE_SHARE, DRAWING_SHARE = 0.2, 0.05
"""How much of a limited time goes to annealing, and to PRADA where annealing may not do. Chosen."""

POLICY_SHARE = 0.6
"""How much of a limited time may be over, where a goal alone is paid, when hoping begins. Chosen."""

LIKELY = 0.5
"""The share of what a goal pays from which on nothing is hoped for. Chosen."""

WORDS, FRESH_WORDS = 4, 64
"""A chain values sequences by 64 runs a word, and what it finds is valued again by fresh ones. Chosen."""

REACHING_STATES = 2_000_000
"""States up to which a problem without a horizon is solved: there is no other way for it. Chosen: some
gigabytes, and half a minute."""

Actions = tuple[int, ...]


@dataclass(frozen=True, slots=True)
class Found:
    """A course, what it is worth with its earliness, whose value that is (`Plan`), and how many sequences and
    descents were tried in all; the policy, of whose course that is."""

    course: Course
    value: float
    earliness: float
    measure: str
    tried: int
    policy: Policy | None = None


@dataclass(frozen=True, slots=True)
class PradaPlusOptions(PradaOptions):
    """The best policy is calculated where that costs at most `solve` times as much as it costs to search
    until the episode ends (solving.py). Else a tree is searched whose new states are valued by so many `runs`
    of each base policy; with 0 the plan is the best sequence. The rest is for the PRADA whose plan is
    improved."""

    solve: float = option(1.0, 0, 1_000)
    runs: int = option(2, 0, 1_000)


def prada_plus(prepared: Prepared, options: Options, own: PradaPlusOptions) -> Plan:
    """The best policy where few states can be reached, and otherwise the best that a search finds with about
    `samples` sequences, or with as many as `time_limit` allows; empty where stopping at once is preferred.

    The value of what was searched for is the mean of runs that chose nothing, so it is not too high for
    having been chosen. Solving takes what it takes, once an episode; the time limit is the search's."""
    if prepared.task.reaching is not None:
        return reaching.plan("prada+", prepared, REACHING_STATES, exact.ExactOptions().error)
    begun = lowered = loaded = time.perf_counter()
    limits = solving.limits(prepared, options, own.solve)
    if not own.solve or exact.at_hand(prepared, limits.states, limits.transitions) is None:
        _ = prepared.process
        lowered = time.perf_counter()
        exact.load(prepared)
        loaded = time.perf_counter()
    solved = solving.solution(prepared, limits) if own.solve else None
    if solved is not None:
        value, policy = exact.worth(prepared, solved)
        course = policy.course(policy.start)
        times = (begun, lowered, loaded, time.perf_counter())
        return course_plan("prada+", prepared.task, course, value, times=times, policy=policy)
    ended = time.perf_counter()
    _ = prepared.tables
    tabled = time.perf_counter()
    _load(prepared, own)
    ready = time.perf_counter()
    found = _searched(prepared, options, own)
    lowering, loading = lowered - begun + tabled - ended, loaded - lowered + ready - tabled
    searching = ended - loaded + time.perf_counter() - ready
    return course_plan(
        "prada+",
        prepared.task,
        found.course,
        found.value,
        times=tuple(itertools.accumulate((0.0, lowering, loading, searching))),
        measure=found.measure,
        samples=found.tried,
        policy=found.policy,
    )


def _searched(prepared: Prepared, options: Options, own: PradaPlusOptions) -> Found:
    """The best policy of a search that starts from the best sequence, or that sequence where no policy is
    seen to be better, or nothing where stopping is. Where nothing is paid but for a goal, and that is not
    seen to be reached more often than not, what leads nearer to it."""
    task, begun, limit = prepared.task, time.perf_counter(), options.time_limit
    goal = policy_search.goal_alone(task) and own.runs > 0
    shares = (SEQUENCE_SHARE if own.runs else 1.0, POLICY_SHARE if goal else 1.0, 1.0)
    ends = [None if limit is None else begun + share * limit for share in shares]
    best, tried = _best_sequence(prepared, options, own, ends[0])
    value, earliness = kernels.annealing.worth(prepared, best, FRESH_WORDS, options.seed + 1)
    found = Found(Course(best), value, earliness, "sampled", tried)
    way = policy_search.way_to_goal(prepared) if goal else ()
    if own.runs:
        starts = [best, way] if way else [best, *_other_starts(prepared, options, own, best)]
        grown = policy_search.search(prepared, starts, own.runs, _effort(options, ends[1]))
        found = replace(found, tried=tried + grown.descents)
        if preferred(grown.value, grown.earliness, *policy_search.carried_out(prepared, best, options.seed)):
            found = Found(grown.course, grown.value, grown.earliness, "policy", found.tried, grown.policy)
    steps = len(way or found.course.actions)
    if goal and found.value < LIKELY * task.discount**steps * policy_search.prize(task):
        hope = policy_search.hopeful(prepared, way, _effort(options, ends[2]))
        if hope.course.actions:
            return Found(hope.course, hope.value, 0.0, "hoped", found.tried + hope.descents, hope.policy)
    return found if beats_nothing(task, found.value, found.earliness) else replace(found, course=Course())


def _effort(options: Options, deadline: float | None) -> policy_search.Effort:
    descents = -(-options.samples // DESCENT_SHARE)
    return policy_search.Effort(descents, deadline, options.seed)


def _other_starts(prepared: Prepared, options: Options, own: PradaOptions, best: Actions) -> list[Actions]:
    """The sequence that hopes; and what PRADA finds with half of the samples, or in a twentieth of the time,
    where annealing has found nothing, or no count on the way to a goal has told it better from worse."""
    hoped = policy_search.hoped_for(prepared)
    if best and prepared.task.counted is not None:
        return [hoped]
    number = {action: index for index, action in enumerate(prepared.task.actions)}
    limit = None if options.time_limit is None else DRAWING_SHARE * options.time_limit
    half = replace(options, samples=1 + options.samples // 2, time_limit=limit)
    drawn = prada(prepared, half, replace(own, margin=0.0))
    return [hoped, tuple(number[action] for action in drawn.actions)]


def _best_sequence(
    prepared: Prepared, options: Options, own: PradaOptions, deadline: float | None
) -> tuple[Actions, int]:
    """The best of the chains' sequences by fresh runs, and how many sequences were tried."""
    found, tried = _annealed(prepared, options, own, deadline)
    worth, best = kernels.annealing.worth, found[0]
    known = worth(prepared, best, FRESH_WORDS, options.seed)
    for actions in found[1:]:
        other = worth(prepared, actions, FRESH_WORDS, options.seed)
        if preferred(*other, *known):
            best, known = actions, other
    return best, tried


def _annealed(
    prepared: Prepared, options: Options, own: PradaOptions, deadline: float | None
) -> tuple[list[Actions], int]:
    """The best sequence of each chain, and how many sequences were tried in all."""
    few = 1 + options.samples // BELIEF_SHARE if deadline is None else FIRST_MOVES
    number = {action.key: index for index, action in enumerate(prepared.task.actions)}
    first = prada(prepared, replace(options, samples=few, time_limit=None), own)
    plans = (first.actions, options.previous)
    starts = [tuple(number[action.key] for action in plan if action.key in number) for plan in plans]

    def chain(index: int, moves: int) -> Actions:
        seed = options.seed + (index + 2) * 2**32
        return kernels.annealing.chain(prepared, starts[index % len(starts)], moves, WORDS, seed)

    found: list[Actions] = []
    tried = 0
    with ThreadPoolExecutor(options.threads) as pool:
        for together, moves in _schedule(options, deadline):
            found += pool.map(chain, range(len(found), len(found) + together), [moves] * together)
            tried += together * moves
    return found, tried


def _schedule(options: Options, deadline: float | None) -> Iterator[tuple[int, int]]:
    """How many chains to run next, and how many changes each of them is to try.

    Until a deadline chains double in length, so that the last ones take about half the time; they are as
    short as what is left of it asks for.
    """
    if deadline is None:
        yield CHAINS, -(-options.samples // CHAINS)
        return
    together, moves, left = options.threads, FIRST_MOVES, options.samples
    while left > 0:
        begun = time.perf_counter()
        yield together, min(moves, left)
        now = time.perf_counter()
        left -= together * moves
        pace = moves / (now - begun)
        moves = min(2 * moves, int(pace * (deadline - now)))
        if moves < FIRST_MOVES:
            return


def _load(prepared: Prepared, own: PradaPlusOptions) -> None:
    """Makes numba load or compile what will run; one step ahead, for this is done before each plan."""
    brief = prepared.at(prepared.task.initial, 1)
    kernels.annealing.chain(brief, (), 0, WORDS, 0)
    kernels.annealing.worth(brief, (), WORDS, 0)
    prada(brief, Options(samples=1), own)
    if own.runs:
        policy_search.load(brief)
