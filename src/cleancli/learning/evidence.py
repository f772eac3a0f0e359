"""Transitions as what learning needs of them, in the order in which they came (§5)."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass

from cleancli.learning.experience import Transition
from cleancli.learning.match import Match, Matcher

Weights = Mapping[Match, float]
"""How many transitions there were of each kind; old ones may count for less than one each."""


@dataclass(frozen=True, slots=True)
class Evidence:
    """What there is to learn from: the `kinds` of transitions, as they were first met, and by its index the
    kind of each transition in turn; of actions the milliseconds that each execution took, in turn; and where
    something was expected of them, what they took beside what was expected."""

    kinds: tuple[Match, ...] = ()
    order: tuple[int, ...] = ()
    times: tuple[tuple[str, tuple[int, ...]], ...] = ()
    estimates: tuple[tuple[str, tuple[tuple[int, int], ...]], ...] = ()

    def rules(self) -> Iterator[tuple[int | None, list[int]]]:
        """Each rule that there are transitions of (None: the default rule), with the indices of these in
        turn."""
        found: dict[int | None, list[int]] = {}
        for index, kind in enumerate(self.order):
            found.setdefault(self.kinds[kind].rule, []).append(index)
        yield from found.items()

    def examples(self) -> dict[int | None, int]:
        """How many transitions there are of each rule."""
        return {rule: len(indices) for rule, indices in self.rules()}


NO_EVIDENCE = Evidence()


class Collector:
    """Evidence while it is put together."""

    def __init__(self, evidence: Evidence = NO_EVIDENCE) -> None:
        self._index = {kind: index for index, kind in enumerate(evidence.kinds)}
        self._order = list(evidence.order)
        self._times = {name: list(times) for name, times in evidence.times}
        self._estimates = {name: list(pairs) for name, pairs in evidence.estimates}
        self._same: dict[int, int] = {}

    def add(self, match: Match, transition: Transition) -> None:
        """One more transition, and which outcomes may have made it."""
        self._order.append(self._index.setdefault(match, len(self._index)))
        action, lasted = transition.action, transition.lasted
        if lasted is not None:
            if transition.expected:
                self._estimates.setdefault(action, []).append((lasted, transition.expected))
            # Equal numbers are one object in memory, since there are many more times than different ones.
            self._times.setdefault(action, []).append(self._same.setdefault(lasted, lasted))

    @property
    def evidence(self) -> Evidence:
        """All of it so far."""
        times = tuple((name, tuple(times)) for name, times in self._times.items())
        estimates = tuple((name, tuple(pairs)) for name, pairs in self._estimates.items())
        return Evidence(tuple(self._index), tuple(self._order), times, estimates)


def collected(matcher: Matcher, transitions: Iterable[Transition]) -> Evidence:
    """What transitions are evidence of. Raises `Refused` (E602)."""
    return extended(NO_EVIDENCE, matcher, transitions)


def extended(evidence: Evidence, matcher: Matcher, transitions: Iterable[Transition]) -> Evidence:
    """The evidence with some more transitions. Raises `Refused` (E602)."""
    collector = Collector(evidence)
    for transition in transitions:
        collector.add(matcher.match(transition), transition)
    return collector.evidence


def together(parts: Iterable[Evidence]) -> Evidence:
    """All evidence, one part after the other."""
    index: dict[Match, int] = {}
    order: list[int] = []
    times: dict[str, tuple[int, ...]] = {}
    estimates: dict[str, tuple[tuple[int, int], ...]] = {}
    for part in parts:
        own = [index.setdefault(kind, len(index)) for kind in part.kinds]
        order += [own[kind] for kind in part.order]
        for name, each in part.times:
            times[name] = times.get(name, ()) + each
        for name, pairs in part.estimates:
            estimates[name] = estimates.get(name, ()) + pairs
    return Evidence(tuple(index), tuple(order), tuple(times.items()), tuple(estimates.items()))


def weights(evidence: Evidence, forgetting: float) -> Weights:
    """What the transitions of each kind count for together: one each, or where there is `forgetting`, the
    last of its rule one, and each before it less by that share than the one after it."""
    if not forgetting:
        return {evidence.kinds[kind]: number for kind, number in Counter(evidence.order).items()}
    found: dict[Match, float] = {}
    for _, indices in evidence.rules():
        weight = 1.0
        for index in reversed(indices):
            match = evidence.kinds[evidence.order[index]]
            found[match] = found.get(match, 0.0) + weight
            weight *= 1 - forgetting
    return found
