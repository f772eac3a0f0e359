"""Whether what a checkpoint says that an episode knows can be an episode's with this domain.

A checkpoint's types are right when it comes here; its names and numbers may be anybody's.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable
from dataclasses import astuple
from itertools import chain, pairwise
from math import dist

from cleancli.execution.episode_state import EpisodeState, Move, Situation
from cleancli.execution.setup import MOST
from cleancli.language.diagnostics.plural import plural
from cleancli.language.model import Domain, Object, State
from cleancli.learning.evidence import Evidence
from cleancli.learning.match import outcomes_of
from cleancli.motion.path import ToolPath
from cleancli.perception.area import Area

FARTHEST = 1e3
"""Metres, metres a second, radians."""

LONGEST = 3600.0
"""Seconds of a path."""

_AREA = re.compile(r"a[1-9]\d{0,8}")


def check_fits(episode: EpisodeState, domain: Domain, given: Collection[Object] | None) -> None:
    """Raises ValueError, with the reason, for an episode that is not of this domain, or whose numbers are
    absurd. `given`: the objects of a problem in the symbolic world; None of a table, where objects come and
    go."""
    if any(not 0 <= number <= MOST for number in _counts(episode)):
        raise ValueError("its counts or seconds are absurd")
    if any(not 0 <= rule < len(domain.rules) for rule, _ in episode.examples):
        raise ValueError("it has seen rules that the domain has not")
    check_evidence(episode.evidence, domain)
    situation = episode.situation
    if situation is not None:
        _check_situation(situation, domain, given)
    known = {thing.name for thing in (*domain.constants, *(given or ()))} if given is not None else None
    for move in (*episode.queue, *(each.move for each in episode.shown)):
        _check_move(move, domain, known)
    for action in episode.rest:
        _check_move(Move(action.name, action.objects), domain, known)
        if not 0 <= (action.duration or 0) <= MOST:
            raise ValueError(f"{action} would take {action.duration:g} seconds")
    for vain in episode.vain:
        _check_areas(vain.areas)
        if not 0 <= vain.chance <= 1:
            raise ValueError("the chance of a failure is none")


def check_evidence(evidence: Evidence, domain: Domain) -> None:
    """Of rules that there are, with an entry for each outcome; and of kinds that there are. Raises
    ValueError."""
    for match in evidence.kinds:
        if match.rule is not None and not 0 <= match.rule < len(domain.rules):
            raise ValueError("it has learned of rules that the domain has not")
        if len(match.fits) != len(outcomes_of(domain, match.rule)):
            raise ValueError("it has learned of outcomes that the domain has not")
        if any(not 0 <= part <= MOST for fit in match.fits for part in fit or ()):
            raise ValueError("what it has learned counts absurdly")
    if any(not 0 <= kind < len(evidence.kinds) for kind in evidence.order):
        raise ValueError("it has learned of a kind of transition that it does not describe")
    names = {action.name for action in domain.actions}
    for name, timed in evidence.times:
        if name not in names or any(not 0 <= milliseconds <= 1000 * MOST for milliseconds in timed):
            raise ValueError("what it has learned of durations is none of this domain")
    for name, pairs in evidence.estimates:
        if name not in names or any(not 0 <= took <= 1000 * MOST for took, _ in pairs):
            raise ValueError("what it has learned of durations is none of this domain")
        if any(not 0 < expected <= 1000 * MOST for _, expected in pairs):
            raise ValueError("what was expected of durations is none")


def _counts(episode: EpisodeState) -> Iterable[float]:
    yield from (episode.looks, episode.named, episode.actions, episode.clear_looks, episode.loading)
    yield from episode.spent.by_kind().values()
    yield from chain.from_iterable(episode.examples)
    yield from (vain.times for vain in episode.vain)


def _check_situation(situation: Situation, domain: Domain, given: Collection[Object] | None) -> None:
    _check_areas(situation.areas)
    if not 0 <= situation.hidden <= 1:
        raise ValueError("the share that was hidden is none")
    types, names = {each.name for each in domain.types}, [thing.name for thing in situation.objects]
    if len(set(names)) < len(names) or any(thing.type not in types for thing in situation.objects):
        raise ValueError("its objects are not of this domain")
    if given is not None and set(situation.objects) != set(given):
        raise ValueError("its objects are not those of the problem")
    _check_facts(situation.state, domain, {*names, *(thing.name for thing in domain.constants)})


def _check_facts(facts: State, domain: Domain, known: Collection[str]) -> None:
    symbols = {symbol.name: symbol for symbol in domain.symbols}
    for fact in facts:
        symbol = symbols.get(fact.symbol)
        if symbol is None or len(symbol.parameters) != len(fact.objects) or not {*fact.objects} <= {*known}:
            raise ValueError(f"the domain has no {fact.symbol!r} for {len(fact.objects)} of its objects")
        if type(fact.value) is not type(symbol.values[0]) or fact.value not in symbol.values:
            raise ValueError(f"{fact.symbol} cannot be {fact.value!r}")


def _check_areas(areas: Iterable[Area]) -> None:
    names = [area.name for area in areas]
    if len(set(names)) < len(names) or not all(map(_AREA.fullmatch, names)):
        raise ValueError("its areas are not named as areas are")
    for area in areas:
        ellipse = area.ellipse
        sizes = (*ellipse.axes, area.covered)
        places = (*ellipse.centre, ellipse.angle)
        if any(not 0 <= size <= FARTHEST for size in sizes) or any(not abs(p) <= FARTHEST for p in places):
            raise ValueError(f"{area.name} is nowhere near a table")


def _check_move(move: Move, domain: Domain, known: Collection[str] | None) -> None:
    """A strategy's own paths need no action of the domain."""
    if move.path is not None:
        return _check_path(move.path)
    arities = {action.name: len(action.parameters) for action in domain.actions}
    if arities.get(move.action) != len(move.objects):
        raise ValueError(
            f"the domain has no action {move.action!r} for {plural(len(move.objects), 'object')}"
        )
    if known is not None and not {*move.objects} <= {*known}:
        raise ValueError(f"{move} is about what the problem has not")
    return None


def _check_path(path: ToolPath) -> None:
    points = path.waypoints
    if path.dustpan is not None:
        points = (*points, path.dustpan.place, path.dustpan.empty)
    if not path.waypoints or any(not abs(number) <= FARTHEST for p in points for number in astuple(p)):
        raise ValueError("a path leads nowhere near a table")
    lengths = [dist((a.x, a.y, a.z), (b.x, b.y, b.z)) for a, b in pairwise(points)]
    if (
        any(p.speed <= 0 for p in points)
        or sum(length / p.speed for length, p in zip(lengths, points[1:], strict=True)) > LONGEST
    ):
        raise ValueError("a path takes hours")
