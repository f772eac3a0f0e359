"""What an episode believes of its rules, where it learns from each action (§5)."""

from __future__ import annotations

from collections import Counter

from cleancli.execution.episode_state import Evidence
from cleancli.execution.setup import EpisodeSetup
from cleancli.language.model import Domain
from cleancli.learning.durations import once, together
from cleancli.learning.experience import Transition
from cleancli.learning.learn import Lesson, learned_from, revised
from cleancli.learning.match import Matcher
from cleancli.learning.method import Method


def with_transition(setup: EpisodeSetup, evidence: Evidence, transition: Transition) -> Evidence:
    """The evidence with one more transition; as it is where nothing is learned."""
    method = setup.options.learning
    if method is None:
        return evidence
    numbers = Counter(dict(evidence.matches))
    numbers[Matcher(setup.domain, method.is_strict).match(transition)] += 1
    times = dict(evidence.times)
    if transition.lasted is not None:
        times = together(times, {transition.action: once(transition.lasted)})
    return Evidence(tuple(numbers.items()), tuple(times.items()))


def lesson(setup: EpisodeSetup, evidence: Evidence) -> Lesson | None:
    """What the evidence teaches, beside what the domain's text has counted; None where nothing is learned."""
    method = setup.options.learning
    if method is None or not evidence.matches:
        return None
    return lesson_of(setup.domain, evidence, method)


def lesson_of(domain: Domain, evidence: Evidence, method: Method) -> Lesson:
    """The same of a domain, by some method."""
    return learned_from(domain, Counter(dict(evidence.matches)), method, dict(evidence.times), adding=True)


def believed(setup: EpisodeSetup, evidence: Evidence) -> Domain:
    """The domain with what is believed now."""
    taught = lesson(setup, evidence)
    return setup.domain if taught is None else revised(setup.domain, taught)
