"""What an episode believes of its rules, where it learns from each action (§5)."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

from cleancli.compiler.task import GroundAction
from cleancli.execution.episode_state import ActionKey, EpisodeState
from cleancli.execution.setup import EpisodeSetup, Seconds, within
from cleancli.language.model import Domain, Problem
from cleancli.learning.evidence import Evidence, extended, weights
from cleancli.learning.experience import Transition
from cleancli.learning.exploration.explored import Explored, explored
from cleancli.learning.intervals import Intervals, intervals
from cleancli.learning.learn import Lesson, learned_from, revised
from cleancli.learning.match import Matcher
from cleancli.learning.method import Method
from cleancli.learning.optimism import optimistic


@dataclass(frozen=True, slots=True)
class Belief:
    """The domain with the probabilities and durations that are believed by some evidence, and the `lesson`
    that made them so, with how sure it is; None where nothing has been learned. Where whole rules are
    learned, it is the domain with these, and what they are from is `explored`."""

    evidence: Evidence
    domain: Domain
    lesson: Lesson | None = None
    intervals: Intervals = field(default_factory=dict)
    explored: Explored | None = None


def with_transition(setup: EpisodeSetup, evidence: Evidence, transition: Transition) -> Evidence:
    """The evidence with one more transition; as it is where no probabilities are learned."""
    method = setup.options.learning
    if method is None or setup.options.structure:
        return evidence
    return extended(evidence, Matcher(setup.domain, method.is_strict), [transition])


def belief(
    setup: EpisodeSetup,
    evidence: Evidence,
    experience: Sequence[Transition] = (),
    before: Explored | None = None,
) -> Belief:
    """What is believed now: what the evidence teaches beside what the domain's text has counted; or the rules
    that the experience teaches, of which the first transitions were explored `before`."""
    method = setup.options.learning
    if setup.options.structure and method is not None:
        found = explored(setup.domain, experience, before, method)
        return Belief(evidence, found.domain, explored=found)
    if method is None or not evidence.order:
        return Belief(evidence, setup.domain)
    lesson = lesson_of(setup.domain, evidence, method)
    sure = intervals(setup.domain, weights(evidence, method.forgetting), lesson)
    return Belief(evidence, revised(setup.domain, lesson), lesson, sure)


def lesson_of(domain: Domain, evidence: Evidence, method: Method) -> Lesson:
    """What the evidence teaches about a domain by some method, beside what its text has counted."""
    return learned_from(domain, evidence, method, adding=True)


def planned_with(setup: EpisodeSetup, state: EpisodeState, believed: Domain, problem: Problem) -> Domain:
    """The domain to plan with: what is believed of what the robot can do, or where that was asked for the
    best of what is not known yet."""
    if setup.options.optimism == "rmax":
        believed = optimistic(believed, problem, unknown(setup, state))
    return within(setup.feasible, believed)


def expected_seconds(now: Belief, seconds: Seconds) -> Seconds:
    """What is expected of how long actions take: what the workcell tells, corrected by how long they took."""
    if now.lesson is None or not now.lesson.corrections:
        return seconds
    factors = {each.action: each.factor for each in now.lesson.corrections}

    def corrected(actions: Iterable[GroundAction]) -> dict[ActionKey, float]:
        return {key: factors.get(key[0], 1.0) * told for key, told in seconds(actions).items()}

    return corrected


def unknown(setup: EpisodeSetup, state: EpisodeState) -> frozenset[int]:
    """The rules, by their indices, that were seen too few times to be known (§5.2)."""
    seen = dict(state.examples)
    rules = range(len(setup.domain.rules))
    return frozenset(rule for rule in rules if seen.get(rule, 0) < setup.options.known)
