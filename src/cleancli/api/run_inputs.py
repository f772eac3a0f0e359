"""What goes into a run, and what of it does not fit together."""

from __future__ import annotations

from dataclasses import dataclass, replace

from cleancli.api.checks import check_acts
from cleancli.api.inputs import LoadedDomain, LoadedProblem, refuse_learning_pddl
from cleancli.compiler.task import NoDurationError, Objective
from cleancli.execution.setup import EpisodeOptions, Job, discounts_time
from cleancli.execution.strategies import STRATEGIES
from cleancli.language.diagnostics.diagnostic import Source
from cleancli.language.model import Domain, Problem, Unlimited
from cleancli.learning.evidence import NO_EVIDENCE, Evidence
from cleancli.learning.experience import Transition
from cleancli.learning.method import KNOWN
from cleancli.motion.actions import PICK_UP, can_execute
from cleancli.planning.plan import BadOption
from cleancli.planning.refusal import planning_refused
from cleancli.scene.model import Scene
from cleancli.simulation.compatibility import refuse_unlike
from cleancli.world.robot import Robot


@dataclass(frozen=True, slots=True)
class Inputs:
    """What goes into a run; `sources` are the texts of the domain and of what is `given`, which come last.
    `evidence`: what earlier runs have seen, to learn from. `world` has the rules by which the symbolic world
    acts, where they are not those of the domain. `robot` works on the table in place of the simulated one.
    `experience`: the transitions of earlier runs, where whole rules are learned. `teacher` has the rules of a
    teacher, where a file is one."""

    domain: Domain
    given: Problem | Scene
    sources: tuple[Source, ...]
    options: EpisodeOptions
    job: Job | None
    evidence: Evidence = NO_EVIDENCE
    world: LoadedDomain | None = None
    robot: Robot | None = None
    experience: tuple[Transition, ...] = ()
    teacher: LoadedDomain | None = None


def inputs_of(
    given: LoadedProblem,
    asked: EpisodeOptions,
    *,
    seed: int | None,
    objective: str | None,
    job: str | None,
    known: int | None = None,
    world: LoadedDomain | None = None,
    robot: Robot | None = None,
    teacher: LoadedDomain | None = None,
) -> Inputs:
    """What goes into a run: where it is not asked for, the problem's seed, time as the objective if the
    domain says how long each action takes, and as many examples as make a rule known where one learns (§6.3).

    Raises Refused (E902) where time is asked for and one is not known, BadOption where what is hoped of
    unknown rules makes no difference."""
    if asked.learning is not None:
        refuse_learning_pddl(given.domain)
    if STRATEGIES[asked.strategy].learns_rules and asked.learning is not None:
        asked = replace(asked, structure=True)
    if teacher is not None:
        asked = replace(asked, is_taught=True)
    _check_structure(asked)
    _check_optimism(asked)
    _check_horizon(given.model, asked.optimism, objective)
    with planning_refused(given.sources):
        by_time = _by_time(objective, given.domain.model)
    chosen = next(n for n in (seed, given.model.seed, asked.seed) if n is not None)
    usual = asked.known if asked.learning is None else KNOWN
    return Inputs(
        given.domain.model,
        given.model,
        given.sources,
        replace(asked, seed=chosen, by_time=by_time, known=usual if known is None else known),
        None if job is None else Job(job),
        world=world,
        robot=robot,
        teacher=teacher,
    )


def _check_structure(asked: EpisodeOptions) -> None:
    if STRATEGIES[asked.strategy].learns_rules and asked.learning is None:
        raise BadOption(
            f"the strategy {asked.strategy} learns rules while it works: ask for learning (`--learn`)"
        )
    if asked.structure and asked.learning is None:
        raise BadOption("structure is what of the rules is learned: ask for learning as well (`--learn`)")
    if asked.is_taught and not STRATEGIES[asked.strategy].learns_rules:
        raise BadOption(f"a teacher is for the strategy explore, and {asked.strategy} asks nobody")
    if asked.structure and asked.optimism != "prior":
        raise BadOption(
            f"optimism {asked.optimism} is about the probabilities of rules; where whole rules are learned,"
            " the strategy explore hopes"
        )


def _check_optimism(asked: EpisodeOptions) -> None:
    if asked.optimism == "prior":
        return
    if asked.learning is None:
        raise BadOption(
            f"optimism {asked.optimism} is about rules that are being learned: ask for learning (`--learn`)"
        )
    if STRATEGIES[asked.strategy].planner is None:
        raise BadOption(f"optimism {asked.optimism} is for plans, and the strategy {asked.strategy} has none")


def _check_horizon(given: Problem | Scene, optimism: str, objective: str | None) -> None:
    if isinstance(given, Problem) and isinstance(given.horizon, Unlimited):
        if optimism != "prior":
            raise BadOption(f"optimism {optimism} hopes for reward, and without a horizon none counts")
        if objective == Objective.REWARD.value:
            raise BadOption("without a horizon no reward counts: the objective is time, or left out")


def _by_time(objective: str | None, domain: Domain) -> bool:
    """Whether plans discount by time. Raises NoDurationError where they are to and one is not known."""
    unknown = [action.name for action in domain.actions if action.duration is None]
    if objective == "time" and unknown:
        raise NoDurationError(unknown)
    return objective == "time" or (objective is None and discounts_time(domain))


def refuse_impossible(inputs: Inputs) -> None:
    """Raises BadOption for what a scene or a problem has not, Refused for a world of other things."""
    given, options, job = inputs.given, inputs.options, inputs.job
    if isinstance(given, Problem) and STRATEGIES[options.strategy].needs_places:
        raise BadOption(f"--strategy {options.strategy} goes by places, which only a scene has")
    if inputs.world is not None:
        _check_world(inputs, inputs.world)
    elif isinstance(given, Problem) and options.structure:  # of a domain that may be a vocabulary alone
        check_acts(inputs.domain)
    if inputs.teacher is not None and isinstance(given, Problem):
        refuse_unlike(inputs.domain, inputs.teacher.model, given, inputs.sources, inputs.teacher.sources)
    if isinstance(given, Scene) and options.is_taught:
        raise BadOption("a teacher is for problems: nobody shows a robot at a table what to do yet")
    if isinstance(given, Problem) and inputs.robot is not None:
        raise BadOption("`robot` is for scenes: a list of facts is carried out in the symbolic world")
    if isinstance(given, Scene) and job is Job.DUSTPAN and not can_execute(PICK_UP, 1, given.arms):
        raise BadOption(f"--job dustpan takes a second arm, which {given.robot} has not")


def _check_world(inputs: Inputs, world: LoadedDomain) -> None:
    """Raises BadOption where a table is the world, and Refused (E901) where the rules are of other things."""
    if isinstance(inputs.given, Scene):
        raise BadOption("--world is for problems: what happens on the table of a scene is physics")
    refuse_unlike(inputs.domain, world.model, inputs.given, inputs.sources, world.sources)
