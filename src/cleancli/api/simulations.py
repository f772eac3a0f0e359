"""What planners achieve in the symbolic world, over many episodes."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import chain
from pathlib import Path

from cleancli.api.asked import Asked, named
from cleancli.api.checks import check_acts, check_least, check_one_of
from cleancli.api.goals import first_and_longer, is_hopeless
from cleancli.api.inputs import (
    GivenDomain,
    GivenProblem,
    LoadedDomain,
    LoadedProblem,
    load_domain,
    load_problem,
)
from cleancli.api.lessons import Counting
from cleancli.api.plain import fields_of
from cleancli.api.seen import seen
from cleancli.api.simulated_experience import write_experience
from cleancli.api.simulation_result import DeadEnds, SimulationResult
from cleancli.compiler.horizon import first_horizon
from cleancli.compiler.rewards import usual_objective
from cleancli.compiler.short_horizon import dead_ends
from cleancli.language.diagnostics.plural import plural
from cleancli.language.load import located_in
from cleancli.language.model import Horizon, Problem, Unlimited
from cleancli.learning.exploration.simulated import EXPLORE, RANDOM, Judged, explorations, wanderings
from cleancli.learning.method import KNOWN
from cleancli.planning.choice import planner_named
from cleancli.planning.plan import BadOption
from cleancli.planning.refusal import planning_refused
from cleancli.planning.registry import PLANNERS
from cleancli.simulation.batch import Batch, spread
from cleancli.simulation.compatibility import refuse_unlike
from cleancli.simulation.episode import Episode, EpisodeLimits, Reason, end_of
from cleancli.simulation.summary import summarized
from cleancli.simulation.symbolic_world import world_of

PLAN = "plan"
STRATEGIES = PLAN, EXPLORE, RANDOM
"""How the next action is chosen."""

_FIXED = "the horizon is fixed: each plan looks {steps} ahead again"
_FOLLOWING = (
    "the horizon follows a count: the first plan looks {steps} ahead,"
    " and the next one as far where the count has not fallen"
)
_LONGER = (
    ", so that the return and the share of successes may be more than those of one plan"
    " (`--max-actions {limit}` ends episodes where the first plan ends)"
)
_SHORTER = (
    "{looked}, and `--max-actions {limit}` ended {early} early, so that fewer succeed than a plan says:"
    " a greater number leaves more time"
)
"""How far plans look ahead, beside how long episodes are."""


def simulate(
    domain: GivenDomain,
    problem: GivenProblem,
    *,
    planner: str | Sequence[str] | None = None,
    episodes: int = 100,
    world: GivenDomain | None = None,
    samples: int | None = None,
    seed: int | None = None,
    time_limit: float | None = None,
    max_actions: int = 60,
    commit: int = 1,
    jobs: int = 1,
    objective: str | None = None,
    options: Mapping[str, object] | None = None,
    think: bool = False,
    record: str | Path | None = None,
    strategy: str = PLAN,
    known: int | None = None,
) -> SimulationResult:
    """Simulate episodes of one planner or several: plan with the rules of `domain`, do the first actions,
    plan again; the world acts by the rules of `world`, or else of `domain`. `options` of planners by name,
    as for `plan`. With `think` the seconds that planners take count as robot time. What was done is written
    into `record`, a new experience file, where one is named.

    The `strategy` is one of STRATEGIES: to plan, to act at random, or to explore until rules have so many
    examples that they count as `known`. Who explores begins with the rules of `domain` where `world` has
    others, else with its vocabulary alone.

    Raises Refused for mistakes in the texts and for what cannot be planned, ValueError for options that make
    no sense, and OSError where the record cannot be written. With several `jobs` a script must keep
    `if __name__ == "__main__":`, as for any processes.
    """
    asked = Asked(samples, seed, time_limit, None if jobs == 1 else 1, objective, named(options))
    check_least(1, episodes=episodes, commit=commit, jobs=jobs)
    check_least(0, max_actions=max_actions)
    names = (planner,) if isinstance(planner, str) else tuple(planner or ())
    for name in names:
        check_one_of("planner", name, tuple(PLANNERS))
    given = load_problem(problem, domain)
    acting = given.domain if world is None else load_domain(world)
    acts = Acts(strategy, known, jobs)
    setup = batch(given, acting, names, asked, EpisodeLimits(max_actions, commit, think=think), acts)
    sources = (*given.domain.sources, *acting.sources, given.source)
    with located_in(*sources), planning_refused(sources):
        result = simulation_result(setup, strategy, acts.episodes(setup, episodes))
    if record is not None:
        write_experience(setup, result, Path(record))
    return result


@dataclass(frozen=True, slots=True)
class Acts:
    """How the next action is chosen, a `strategy` of STRATEGIES; for one that explores, how many examples a
    rule has when it is known; and the processes. Raises BadOption for what makes no sense."""

    strategy: str = PLAN
    known: int | None = None
    jobs: int = 1

    def __post_init__(self) -> None:
        check_one_of("strategy", self.strategy, STRATEGIES)
        check_least(0, known=self.known)
        if self.explores and self.jobs > 1:
            raise BadOption(
                "each episode of the strategy explore goes on with what those before have shown,"
                " so that one process carries them out: leave out the number of jobs"
            )
        if self.known is not None and not self.explores:
            raise BadOption("how many examples make a rule known matters to the strategy explore alone")

    @property
    def explores(self) -> bool:
        """Whether rules are sought."""
        return self.strategy == EXPLORE

    def names(self, planners: Sequence[str], problem: Problem) -> tuple[str, ...]:
        """Those of the planners; none where nothing is planned."""
        if self.strategy != RANDOM:
            return tuple(dict.fromkeys(planners)) or (planner_named(None, problem),)
        if planners:
            raise BadOption("the strategy random plans nothing: leave out the planner")
        return ()

    def episodes(self, setup: Batch, number: int) -> Iterator[Judged]:
        """So many episodes, as they come to an end. Raises what planners raise."""
        if self.explores:
            known = KNOWN if self.known is None else self.known
            return explorations(setup, known, Counting().method(setup.domain), number)
        if self.strategy == RANDOM:
            return wanderings(setup, number)
        return (Judged(played, ()) for played in spread(setup, number, self.jobs))


def batch(
    given: LoadedProblem,
    world: LoadedDomain,
    planners: Sequence[str],
    asked: Asked,
    limits: EpisodeLimits,
    acts: Acts,
) -> Batch:
    """What is to be simulated; a scene is looked at once, with its own seed. Raises Refused where the world
    speaks another language than the domain, and BadOption."""
    looked, _ = seen(given, None, {})
    believed = looked.domain
    chosen, options = asked.of(looked.problem, asked.seed, acts.names(planners, looked.problem))
    if world is given.domain:
        acting = looked.domain
    else:
        acting = world.model
        refuse_unlike(looked.domain, acting, looked.problem, given.domain.sources, world.sources)
    if acts.explores and world is given.domain:
        check_acts(acting)
        believed = replace(believed, rules=(), default=(), parameters=(), learned=None)
    return Batch(
        believed,
        acting,
        looked.problem,
        chosen,
        options,
        limits,
        asked.objective,
    )


def _names(setup: Batch, strategy: str) -> list[str]:
    """What the rows are called: as the planners, but where these do not plan alone as the strategy."""
    planners = [planner.name for planner in setup.planners]
    if strategy == PLAN:
        return planners
    return [f"{strategy}, {name}" for name in planners] if len(planners) > 1 else [strategy]


def simulation_result(setup: Batch, strategy: str, judged: Iterable[Judged]) -> SimulationResult:
    """All episodes, put in order, with what they come to. Raises what planners raise."""
    ordered = sorted(judged, key=lambda each: each.played[0].number)
    found = tuple(zip(*(each.played for each in ordered), strict=True))
    names = _names(setup, strategy)
    summaries = (
        summarized(name, each, found[0] if each is not found[0] else None)
        for name, each in zip(names, found, strict=True)
    )
    options = fields_of(setup.options)
    for planner in setup.planners:
        options |= fields_of(planner.own)
    return SimulationResult(
        problem=setup.problem.name,
        domain=setup.domain.name,
        world=setup.world.name,
        strategy=strategy,
        objective=setup.objective or usual_objective(setup.domain, setup.problem).value,
        options=options,
        max_actions=setup.limits.max_actions,
        commit=setup.limits.commit,
        think=setup.limits.think,
        planners=tuple(summaries),
        episodes=found,
        short_horizon=_short_horizon(setup, chain(*found)),
        lengths=_lengths(setup, tuple(chain(*found))) if setup.planners else None,
        hopeless=_is_hopeless(setup, chain(*found)),
        dead_ends=tuple(_dead_ends(setup, each) for each in found),
        variations=tuple(zip(*(each.variations for each in ordered), strict=True)),
    )


def _short_horizon(setup: Batch, played: Iterable[Episode]) -> tuple[int, int] | None:
    """The horizon of the first plan and a longer one, where the problem states none and planners gave
    episodes up."""
    given_up = any(each.reason is Reason.IDLE and each.success is False for each in played)
    if not given_up or setup.problem.horizon is not None:
        return None
    return first_and_longer(setup.domain, setup.problem, setup.options.counted)


def _is_hopeless(setup: Batch, played: Iterable[Episode]) -> bool:
    """Whether it is known that no episode could reach the goal."""
    return not any(each.success for each in played) and is_hopeless(setup.world, setup.problem)


def _dead_ends(setup: Batch, played: Iterable[Episode]) -> DeadEnds | None:
    """Of the episodes that a planner gave up, those in which the goal could no longer be reached."""
    given_up = [each for each in played if each.reason is Reason.IDLE and each.success is False]
    if not given_up or not setup.problem.goal:
        return None
    world = world_of(setup.world, setup.problem, setup.timed)
    number = dead_ends(world.task, (end_of(world, each, setup.options.seed) for each in given_up))
    return DeadEnds(number, len(given_up)) if number else None


def _lengths(setup: Batch, played: Sequence[Episode]) -> str | None:
    """Where episodes are longer than a plan, or end before it, they don't earn what `plan` tells."""
    stated, limit = setup.problem.horizon, setup.limits.max_actions
    steps = None if isinstance(stated, Unlimited) else first_horizon(setup.domain, setup.problem)
    if steps is not None and any(len(each.actions) > steps for each in played):
        ahead = _FIXED if isinstance(stated, Horizon) and stated.count is None else _FOLLOWING
        return ahead.format(steps=plural(steps, "action")) + _LONGER.format(limit=steps)
    early = sum(each.reason is Reason.LIMIT and each.success is False for each in played)
    if early and (steps is None or steps > limit):
        looked = (
            "the horizon is unlimited" if steps is None else f"the first plan looks {steps} actions ahead"
        )
        return _SHORTER.format(looked=looked, limit=limit, early=plural(early, "episode"))
    return None
