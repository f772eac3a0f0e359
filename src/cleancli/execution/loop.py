"""The loop of §4.2.3 and §4.2.4 - look, decide, act, look again - as a generator of events.

All that it knows is an `EpisodeState`, of which each step makes the next; where it works it knows through
`Workcell` alone.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Generator, Iterable, Iterator
from dataclasses import replace
from fractions import Fraction
from functools import partial

from cleancli.compiler.fluents import values_of
from cleancli.compiler.task import GroundAction
from cleancli.execution import seeds
from cleancli.execution.believed import (
    Belief,
    belief,
    expected_seconds,
    planned_with,
    unknown,
    with_transition,
)
from cleancli.execution.episode_state import (
    PATIENCE,
    Account,
    Demonstration,
    EpisodeState,
    FailedAttempt,
    Move,
    Situation,
    about,
    last_failure,
    shown_before,
    unchanged,
    without_vain,
)
from cleancli.execution.events import (
    Acted,
    Checkpoint,
    Decided,
    Ended,
    Event,
    Failed,
    Learned,
    Leaving,
    Looked,
    Purpose,
    Started,
)
from cleancli.execution.foreseen import Foreseen, foreseen
from cleancli.execution.setup import DecisionContext, EpisodeSetup
from cleancli.execution.strategies import STRATEGIES
from cleancli.execution.teaching import Teacher, question
from cleancli.execution.workcell import LookResult, Motions, Workcell
from cleancli.language.diagnostics.plural import plural
from cleancli.learning.experience import Transition, milliseconds
from cleancli.perception.surface import NoSurface
from cleancli.perception.symbols import remembered
from cleancli.perception.tracking import Stroke

CLEAN = "nothing is left to do"
IDLE = "nothing seems worth doing"

CLEAR_LOOKS = 2
"""Looks in a row, with the tool out of view, that must find nothing left before the episode is over."""

Steps = Generator[Event, None, EpisodeState]


def clean(
    setup: EpisodeSetup, cell: Workcell, state: EpisodeState | None = None, teacher: Teacher | None = None
) -> Generator[Event]:
    """Act until nothing is left to do: from a fresh start, or from where another run was in `state`.

    Ends, always with `Ended`: when two looks in a row with the tool out of view find nothing left; when the
    strategy finds nothing worth doing, and a `teacher` neither; when the camera shows no table, or the arm
    cannot leave its view; at the limits on actions and time. An episode that goes on takes a look first,
    wherever the arm is.
    """
    if state is None:
        state = EpisodeState(examples=_seen_before(setup), evidence=setup.evidence)
    elif state.situation is not None and not state.reason:
        state = yield from _look(cell, replace(state, clear_looks=0), Purpose.AFTER, None)
    seen = list(setup.experience)
    now = yield from _learned(belief(setup, state.evidence, seen))
    while not (reason := _over(setup, cell, state)):
        yield Checkpoint(state)
        before = len(seen)
        state = yield from _remembered(_step(setup, cell, state, now, teacher), seen)
        if state.evidence != now.evidence or (setup.options.structure and len(seen) > before):
            now = yield from _learned(belief(setup, state.evidence, seen, now.explored))
    state = replace(state, reason=reason)
    yield Checkpoint(state)
    yield Ended(reason, reason == CLEAN, state.actions, state.spent, cell.clock, state.loading)


def saving(events: Iterable[Event], save: Callable[[], object]) -> Iterator[Event]:
    """The events of an episode whose world is saved once for each number of actions, as a run does.

    A simulated table then goes on from what was saved, built anew: who saves it, and who does not, sees two
    courses of one episode.
    """
    saved = -1
    for event in events:
        yield event
        if isinstance(event, Checkpoint) and event.state.actions != saved:
            saved = event.state.actions
            save()


def _remembered(steps: Steps, seen: list[Transition]) -> Steps:
    """The same steps, of which the transitions that were seen whole are remembered as well. They are in
    experience.jsonl, and so no part of what a checkpoint holds."""
    while True:
        try:
            event = next(steps)
        except StopIteration as ended:
            state: EpisodeState = ended.value
            return state
        if isinstance(event, Acted) and event.seen and event.transition is not None:
            seen.append(event.transition)
        yield event


def _learned(now: Belief) -> Generator[Event, None, Belief]:
    """Say what is believed from now on, if something was learned."""
    if now.lesson is not None:
        yield Learned(now.lesson, now.domain, now.intervals)
    return now


def _over(setup: EpisodeSetup, cell: Workcell, state: EpisodeState) -> str:
    """Why the episode is over; empty while it is not."""
    if state.reason or state.situation is None:
        return state.reason
    if cell.is_done(state.situation):
        return CLEAN if state.clear_looks >= CLEAR_LOOKS else ""
    if state.actions >= setup.options.max_actions:
        return f"the limit of {plural(setup.options.max_actions, 'action')} is reached"
    if state.spent.total >= setup.options.max_seconds:
        return seconds_reached(setup.options.max_seconds)
    return ""


def seconds_reached(limit: float) -> str:
    """Why an episode is over that took so many seconds."""
    return f"the limit of {limit:g} seconds is reached"


def _step(
    setup: EpisodeSetup, cell: Workcell, state: EpisodeState, now: Belief, teacher: Teacher | None
) -> Steps:
    """Whatever is due: a look, a decision by what is believed now, or a move."""
    if state.situation is None:
        return (yield from _clear_look(cell, state, Purpose.FIRST))
    hides = state.situation.shows_nothing and not state.clear_looks
    if hides or cell.is_done(state.situation):
        return (yield from _clear_look(cell, replace(state, queue=()), Purpose.EXTRA))
    if state.queue:
        return (yield from _carry_out(setup, cell, state, state.situation, now))
    return (yield from _decide(setup, cell, state, state.situation, now, teacher))


def _decide(
    setup: EpisodeSetup,
    cell: Workcell,
    state: EpisodeState,
    situation: Situation,
    believed: Belief,
    teacher: Teacher | None,
) -> Steps:
    """Ask the strategy. Where it finds nothing to do while the arm may hide something, look again first."""
    started = time.perf_counter()
    now = _context(setup, cell, state, situation, believed)
    decision = STRATEGIES[setup.options.strategy].decide(now, setup.options)
    # Loading the kernel is no planning: it happens once, and takes long on the very first run only.
    seconds = time.perf_counter() - started - decision.loading
    spent = replace(state.spent, planning=state.spent.planning + seconds)
    state = replace(state, queue=decision.moves, rest=decision.rest, spent=spent)
    state = replace(state, loading=state.loading + decision.loading)
    moves = decision.moves or shown_before(state.shown, situation)
    shown = None if moves or teacher is None else _shown(teacher, believed, now)
    if shown is not None:
        yield Decided(situation, (shown,), None, seconds, is_taught=True)
        told = Demonstration(situation.state, shown)
        return replace(state, queue=(shown,), shown=(*state.shown, told))
    yield Decided(situation, moves, decision.plan if decision.moves else None, seconds)
    if moves:
        return replace(state, queue=moves)
    if state.clear_looks:
        return replace(state, reason=_idle(state))
    return (yield from _clear_look(cell, state, Purpose.EXTRA))


def _context(
    setup: EpisodeSetup, cell: Workcell, state: EpisodeState, situation: Situation, believed: Belief
) -> DecisionContext:
    """What the strategy may know as things stand."""
    options = setup.options
    problem = cell.problem(situation)
    return DecisionContext(
        planned_with(setup, state, believed.domain, problem),
        problem,
        setup.scene,
        setup.job,
        situation,
        cell.tool,
        state.excluded,
        state.rest,
        state.actions,
        # Every decision draws for itself: the seed of a run and the number of moves before name it.
        seeds.derived(options.seed, seeds.Stream.PLANNING) + state.actions,
        expected_seconds(believed, partial(cell.seconds, situation)),
        believed.explored,
    )


def rehearsed(setup: EpisodeSetup, cell: Workcell) -> tuple[LookResult, Started | None]:
    """What an episode would do first, by one look from where the arm is, and what is seen in that; nothing
    moves. None where nothing seems worth doing. Raises NoSurface."""
    state = EpisodeState(examples=_seen_before(setup), evidence=setup.evidence)
    sight = cell.look(None, None, state.looks, state.named)
    now = belief(setup, state.evidence)
    context = _context(setup, cell, replace(state, situation=sight.situation), sight.situation, now)
    moves = STRATEGIES[setup.options.strategy].decide(context, setup.options).moves
    if not moves:
        return sight, None
    return sight, Started(1, moves[0], cell.path(moves[0], sight.situation))


def _shown(teacher: Teacher, believed: Belief, now: DecisionContext) -> Move | None:
    """What a teacher shows of what is to be learned."""
    assert believed.explored is not None, "a teacher is asked where whole rules are learned"
    return teacher(question(believed.explored, now.domain, now.problem, now.seed))


def _idle(state: EpisodeState) -> str:
    """That nothing seems worth doing, and what was tried in vain."""
    failures = dict.fromkeys(vain.reason for vain in state.vain if vain.reason)
    tried = [f"{vain.key[0]}({', '.join(vain.key[1])})" for vain in state.vain if vain.is_given_up]
    return IDLE + (f"; in vain: {', '.join(tried)}" if tried else "") + "".join(f"; {f}" for f in failures)


def _clear_look(cell: Workcell, state: EpisodeState, purpose: Purpose, stroke: Stroke | None = None) -> Steps:
    """Move the arm out of view, and look. A look that has found nothing is taken again where the arm is."""
    yield Leaving()
    motions = yield from cell.withdraw()
    if motions.failure:
        return replace(state, reason=f"the arm cannot leave the camera's view: {motions.failure}")
    seconds = motions.transit + motions.seconds
    state = replace(
        state, spent=_with(state.spent, purpose, seconds, transits=state.spent.transits + seconds)
    )
    state = yield from _look(cell, state, purpose, stroke)
    return replace(state, clear_looks=state.clear_looks + 1)


def _look(cell: Workcell, state: EpisodeState, purpose: Purpose, stroke: Stroke | None) -> Steps:
    """Look from where the arm is. Moves whose objects are gone leave the queue."""
    try:
        sight = cell.look(state.situation, stroke, state.looks, state.named)
    except NoSurface as error:
        return replace(state, reason=str(error), looks=state.looks + 1)
    there = {thing.name for thing in sight.situation.objects}
    queue = tuple(move for move in state.queue if there.issuperset(move.objects))
    state = replace(state, situation=sight.situation, looks=state.looks + 1, named=sight.named)
    state = replace(state, queue=queue if len(queue) == len(state.queue) else ())
    yield Looked(sight.situation, sight.frame, sight.seconds, purpose)
    # With a move in the queue the arm is on its way to it while the picture is understood.
    waited = 0.0 if purpose is Purpose.AFTER and state.queue else sight.seconds
    return replace(
        state, spent=_with(state.spent, purpose, waited, perceiving=state.spent.perceiving + waited)
    )


def _carry_out(
    setup: EpisodeSetup, cell: Workcell, state: EpisodeState, before: Situation, believed: Belief
) -> Steps:
    """Do the next move of the queue, and look what came of it."""
    move, number = state.queue[0], state.actions + 1
    expected = _expected(cell, move, before)
    path = cell.path(move, before, state.times_in_vain(move.key))
    yield Started(number, move, path)
    motions = yield from cell.carry_out(number, move, path)
    spent = replace(
        state.spent,
        transits=state.spent.transits + motions.transit,
        actions=state.spent.actions + motions.seconds,
    )
    state = replace(state, actions=number, queue=state.queue[1:], clear_looks=0, spent=spent)
    if motions.failure:
        state = replace(state, queue=(), rest=())
        yield Failed(number, move, motions.failure)
    told = foreseen(believed.domain, before, move)
    is_new = setup.options.structure or told.rule in unknown(setup, state)
    if is_new and not motions.failure:
        state = yield from _clear_look(cell, state, Purpose.LEARNING, motions.stroke)
    else:
        state = yield from _look_after(cell, state, motions.stroke)
    return (yield from _concluded(setup, state, number, before, told, motions, move, expected))


def _look_after(cell: Workcell, state: EpisodeState, stroke: Stroke | None) -> Steps:
    """Look with the arm where it is, or else, if it hides the table itself, with the arm out of view."""
    after = yield from _look(cell, state, Purpose.AFTER, stroke)
    if not after.reason:
        return after
    return (yield from _clear_look(cell, state, Purpose.EXTRA, stroke))


def _concluded(
    setup: EpisodeSetup,
    state: EpisodeState,
    number: int,
    before: Situation,
    told: Foreseen,
    motions: Motions,
    move: Move,
    expected: float | None,
) -> Steps:
    """Say what came of a move, and remember whether it was of any use."""
    after = state.situation
    if state.reason or after is None:
        return state
    seen = not motions.failure and after.is_full and before.unseen.isdisjoint(move.objects)
    knows_rules = STRATEGIES[setup.options.strategy].planner is not None
    chance = told.nothing if knows_rules else 0.0
    state = replace(
        state,
        vain=_tried(state.vain, move, before, after, chance, motions.failure),
        shown=without_vain(state.shown, move, before, after),
    )
    # Rules that are learned whole come and go: there are none to count by.
    if seen and told.rule is not None and not setup.options.structure:
        counts = dict(state.examples)
        counts[told.rule] = counts.get(told.rule, Fraction(0)) + 1
        state = replace(state, examples=tuple(counts.items()))
    is_action = move.path is None
    transition = _transition(move, before, after, motions, expected) if is_action else None
    yield Acted(number, move, transition, seen and is_action, motions.transit, motions.seconds, after)
    if seen and transition is not None:
        state = replace(state, evidence=with_transition(setup, state.evidence, transition))
    return state


def _tried(
    vain: tuple[FailedAttempt, ...],
    move: Move,
    before: Situation,
    after: Situation,
    chance: float,
    failure: str,
) -> tuple[FailedAttempt, ...]:
    """What has been tried in vain, after one more move that changes nothing with this chance."""
    others = tuple(each for each in vain if each.key != move.key and unchanged(each, after))
    if not move.objects and move.path is not None:  # a strategy's own path, which is another one each time
        return others
    last, looks = last_failure(vain, move.key, before), about(move.objects, before)
    if failure:
        return (*others, FailedAttempt(move.key, *looks, PATIENCE, failure))
    times, chances = (0, 1.0) if last is None else (last.times, last.chance)
    now = FailedAttempt(move.key, *looks, times + 1, chance=chance * chances)
    return (*others, now) if unchanged(now, after) else others


def _expected(cell: Workcell, move: Move, situation: Situation) -> float | None:
    """Seconds that an action is expected to take here, without what was learned of it."""
    if move.path is not None:
        return None
    return cell.seconds(situation, [GroundAction(move.action, move.objects, None)]).get(move.key)


def _transition(
    move: Move, before: Situation, after: Situation, motions: Motions, expected: float | None
) -> Transition:
    """What was believed before and after, over all objects of both; those gone are remembered as clean."""
    objects = tuple(sorted({*before.objects, *after.objects}))
    gone = {o.name for o in before.objects} - {o.name for o in after.objects}
    state = after.state | remembered(before.state, gone)
    lasted = None if motions.failure else milliseconds(motions.transit, motions.seconds)
    states = values_of(before.state), values_of(state)
    told = None if expected is None else round(1000 * expected)
    return Transition(move.action, move.objects, objects, *states, lasted, told)


def _seen_before(setup: EpisodeSetup) -> tuple[tuple[int, Fraction], ...]:
    """How often each rule was seen, by what its text says of its outcomes and in earlier episodes."""
    counts = [
        sum((outcome.seen or Fraction(0) for outcome in rule.outcomes), start=Fraction(0))
        for rule in setup.domain.rules
    ]
    for rule, number in setup.evidence.examples().items():
        if rule is not None:
            counts[rule] += number
    return tuple((index, count) for index, count in enumerate(counts) if count)


def _with(spent: Account, purpose: Purpose, seconds: float, **otherwise: float) -> Account:
    """The account after a look for some purpose, or a way out of view for it, took so long; `otherwise`: what
    it comes to where the look is no more than the loop's next one."""
    match purpose:
        case Purpose.LEARNING:
            return replace(spent, learning=spent.learning + seconds)
        case Purpose.EXTRA:
            return replace(spent, extra_perceptions=spent.extra_perceptions + seconds)
        case Purpose.FIRST | Purpose.AFTER:
            return replace(spent, **otherwise)
