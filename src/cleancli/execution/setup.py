"""What stays as it is in an episode from first look to end, and what a strategy knows when it decides."""

from __future__ import annotations

import enum
import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace

from cleancli.compiler.task import GroundAction
from cleancli.execution.episode_state import ActionKey, Move, Situation
from cleancli.language.model import Domain, Problem, RewardKind, weight_of
from cleancli.learning.evidence import NO_EVIDENCE, Evidence
from cleancli.learning.experience import Transition
from cleancli.learning.exploration.explored import Explored
from cleancli.learning.method import Method
from cleancli.motion.actions import PICK_UP, PICK_UPS, SWEEPS, TO_ZONE, WIPES, can_execute
from cleancli.planning.plan import Plan
from cleancli.scene.model import Scene

TO_CONTAINER = ("moveToContainerFast", "moveToContainerStraight")


Seconds = Callable[[Iterable[GroundAction]], Mapping[ActionKey, float]]
"""About how long actions on their objects take, by their keys."""


class Job(enum.Enum):
    """What becomes of dirt: §6's two tasks, the whiteboard's, and piling it up."""

    CONTAINER = "container"  # moved to the container with the rag (§6.1)
    DUSTPAN = "dustpan"  # picked up with rag and dustpan (§6.2)
    WIPE = "wipe"  # wiped away where it is, as ink
    ZONE = "zone"  # pushed into the scene's zone, where it may lie

    @property
    def cleaning(self) -> tuple[str, ...]:
        """The actions that clean one area, quickest first."""
        return TO_CONTAINER if self is Job.CONTAINER else self.own[:1]

    @property
    def own(self) -> tuple[str, ...]:
        """All actions by which dirt is cleaned away so."""
        match self:
            case Job.CONTAINER:
                return (*TO_CONTAINER, *SWEEPS)
            case Job.DUSTPAN:
                return PICK_UPS
            case Job.WIPE:
                return WIPES
            case Job.ZONE:
                return TO_ZONE


def discounts_time(domain: Domain) -> bool:
    """Whether plans discount by time where nothing else is asked for: all durations are known, and the reward
    does not count them already."""
    timed = all(action.duration is not None for action in domain.actions)
    return timed and not weight_of(domain, RewardKind.DURATION)


def usual_strategy(is_scene: bool) -> str:
    """The strategy where none is asked for. On tables plan-2 is usually best in §6. In the symbolic world
    looks cost nothing, so that nothing is gained by a second action that knows not what the first has done.
    """
    return "plan-2" if is_scene else "plan-1"


def usual_seconds(is_scene: bool) -> float:
    """The limit of seconds where none is asked for: half an hour at a table, and none in the symbolic world,
    whose actions may take minutes or days."""
    return 1800.0 if is_scene else math.inf


def or_usual(is_scene: bool, strategy: str | None, max_seconds: float | None) -> tuple[str, float]:
    """What is asked for, or the usual where nothing is."""
    return strategy or usual_strategy(is_scene), usual_seconds(
        is_scene
    ) if max_seconds is None else max_seconds


@dataclass(frozen=True, slots=True)
class EpisodeOptions:
    """What is asked for. `planner` is the strategy's own where none is given; `by_time`: plans discount by
    how long actions take, not by their number. `max_seconds`: of all that is in the account; infinite where
    there is no limit.

    `known`: after an action whose rule was seen so many times or more, the arm need not leave the camera's
    view to learn from it (§5.2). `learning`: how probabilities are learned from each action; None: they stay.
    `optimism`: what plans hope of rules that are not known yet, of `optimism.OPTIMISM`. `structure`: whole
    rules are learned, and not their probabilities alone (§7.1). `is_taught`: where no plan reaches the goal
    a teacher is asked, and nothing is tried for its own sake.
    """

    strategy: str = usual_strategy(is_scene=True)
    planner: str | None = None
    samples: int = 10_000
    max_actions: int = 60
    max_seconds: float = usual_seconds(is_scene=True)
    seed: int = 1
    by_time: bool = False
    known: int = 0
    learning: Method | None = None
    optimism: str = "prior"
    structure: bool = False
    is_taught: bool = False


@dataclass(frozen=True, slots=True)
class EpisodeSetup:
    """What an episode needs besides a workcell: `feasible` is the domain without what the robot has no skill
    for, `scene` None in the symbolic world. `evidence`: what earlier episodes have seen, to learn from;
    `experience`: their transitions, and those of this one up to where it goes on, where whole rules are
    learned."""

    domain: Domain
    feasible: Domain
    scene: Scene | None
    job: Job
    options: EpisodeOptions
    evidence: Evidence = NO_EVIDENCE
    experience: tuple[Transition, ...] = ()


@dataclass(frozen=True, slots=True)
class DecisionContext:
    """What a strategy may know when it decides.

    `domain` has only the actions that the robot has skills for; `problem` is what there is to plan for, as
    now believed. `scene` and `tool`, where the tool is, are None in the symbolic world. `excluded` moves are
    of no use as things stand. `rest`: what is left of the last plan. `number` of moves begun before; `seed`
    is this decision's own. `seconds` tells about how long actions on their objects take here, by their keys;
    what it leaves out takes as long as the domain says. `explored`: what experience has shown of each action,
    where whole rules are learned.
    """

    domain: Domain
    problem: Problem
    scene: Scene | None
    job: Job
    situation: Situation
    tool: tuple[float, float] | None
    excluded: frozenset[ActionKey]
    rest: tuple[GroundAction, ...]
    number: int
    seed: int
    seconds: Seconds
    explored: Explored | None = None


@dataclass(frozen=True, slots=True)
class Decision:
    """The next moves to carry out before deciding again, and with a plan what is left of it beyond them.
    `loading`: seconds that numba took to load the planner, which happens once."""

    moves: tuple[Move, ...]
    rest: tuple[GroundAction, ...] = ()
    plan: Plan | None = None
    loading: float = 0.0


def usual_job(domain: Domain, arms: int) -> Job:
    """What a robot of so many arms does unless told otherwise: it picks dirt up if it can, and wipes or
    pushes into a zone where the domain knows no other way."""
    known = {action.name for action in domain.actions}
    if known.isdisjoint((*Job.CONTAINER.own, *Job.DUSTPAN.own)):
        for job in (Job.WIPE, Job.ZONE):
            if not known.isdisjoint(job.own):
                return job
    return Job.DUSTPAN if can_execute(PICK_UP, 1, arms) else Job.CONTAINER


def within_reach(domain: Domain, arms: int, job: Job | None = None) -> Domain:
    """The domain without the actions that a robot of so many arms has no skill for, and without their rules;
    given a way of cleaning, without those of the others."""
    others = {name for each in Job if job is not None and each is not job for name in each.own}
    actions = tuple(
        a for a in domain.actions if a.name not in others and can_execute(a.name, len(a.parameters), arms)
    )
    return within(replace(domain, actions=actions), domain)


def within(feasible: Domain, domain: Domain) -> Domain:
    """A domain without the actions that the feasible one has not, and without their rules."""
    names = {action.name for action in feasible.actions}
    return replace(
        domain,
        actions=tuple(action for action in domain.actions if action.name in names),
        rules=tuple(rule for rule in domain.rules if rule.action in names),
    )


MOST = 10**9
"""Of anything that is counted, and seconds."""
