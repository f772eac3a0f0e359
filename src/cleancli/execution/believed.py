"""What an episode believes of its rules, where it learns from each action (§5)."""

from __future__ import annotations

from collections import Counter

from cleancli.execution.setup import EpisodeSetup
from cleancli.language.model import Domain
from cleancli.learning.experience import Transition
from cleancli.learning.learn import Lesson, counted, learned_from, revised
from cleancli.learning.match import Match, Matcher

Evidence = tuple[tuple[Match, int], ...]
"""How many transitions there were of each kind, in the order in which the kinds were first seen."""


def with_transition(setup: EpisodeSetup, evidence: Evidence, transition: Transition) -> Evidence:
    """The evidence with one more transition; as it is where nothing is learned."""
    method = setup.options.learning
    if method is None:
        return evidence
    numbers = Counter(dict(evidence))
    numbers[Matcher(setup.domain, method.is_strict).match(transition)] += 1
    return tuple(numbers.items())


def lesson(setup: EpisodeSetup, evidence: Evidence) -> Lesson | None:
    """What the evidence teaches, beside what the domain's text has counted; None where nothing is learned."""
    method = setup.options.learning
    if method is None or not evidence:
        return None
    return learned_from(setup.domain, Counter(dict(evidence)), method, counted(setup.domain))


def believed(setup: EpisodeSetup, evidence: Evidence) -> Domain:
    """The domain with the probabilities that are believed now."""
    taught = lesson(setup, evidence)
    return setup.domain if taught is None else revised(setup.domain, taught)
