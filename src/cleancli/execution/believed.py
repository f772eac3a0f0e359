"""What an episode believes of its rules, where it learns from each action (§5)."""

from __future__ import annotations

from cleancli.execution.setup import EpisodeSetup
from cleancli.language.model import Domain
from cleancli.learning.evidence import Evidence, extended
from cleancli.learning.experience import Transition
from cleancli.learning.learn import Lesson, learned_from, revised
from cleancli.learning.match import Matcher
from cleancli.learning.method import Method


def with_transition(setup: EpisodeSetup, evidence: Evidence, transition: Transition) -> Evidence:
    """The evidence with one more transition; as it is where nothing is learned."""
    method = setup.options.learning
    if method is None:
        return evidence
    return extended(evidence, Matcher(setup.domain, method.is_strict), [transition])


def lesson(setup: EpisodeSetup, evidence: Evidence) -> Lesson | None:
    """What the evidence teaches, beside what the domain's text has counted; None where nothing is learned."""
    method = setup.options.learning
    if method is None or not evidence.order:
        return None
    return lesson_of(setup.domain, evidence, method)


def lesson_of(domain: Domain, evidence: Evidence, method: Method) -> Lesson:
    """The same of a domain, by some method."""
    return learned_from(domain, evidence, method, adding=True)


def believed(setup: EpisodeSetup, evidence: Evidence) -> Domain:
    """The domain with what is believed now."""
    taught = lesson(setup, evidence)
    return setup.domain if taught is None else revised(setup.domain, taught)
