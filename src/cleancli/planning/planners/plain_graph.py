"""The states of a task and the best policy over them in plain Python: in fractions (rational.py), or in
machine numbers where a task is small and no compiled code has been loaded.

Loading numba and a loop takes a tenth of a second, which is longer than plain Python needs for some dozens of
states. All is added up in the order of planning/kernels (state_graph.py, backward_induction.py), so machine
numbers are the same to the last bit, and no plan depends on what has been loaded.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Generic, TypeVar

from cleancli.compiler.semantics import changed, idle_earliness, idle_worth, payment
from cleancli.compiler.task import GroundCondition, GroundRule, GroundState, Task, asked, holds
from cleancli.planning.preference import preferred

WORK = 20_000
"""Rules asked about states, and transitions valued in steps, up to which a task is small. Chosen: ten
milliseconds."""

FEW_STATES = 20
"""Where so many states a step would be too much work, no state is looked at. Chosen."""

N = TypeVar("N", float, Fraction)


@dataclass(frozen=True, slots=True)
class Choice(Generic[N]):
    """An action (an index), what its step is expected to pay without its `payment`, the step's expected
    progress, and the states (numbers) that may follow, each with its probability."""

    action: int
    reward: N
    progress: N
    after: tuple[tuple[int, N], ...]


@dataclass(slots=True)
class PlainGraph(Generic[N]):
    """The states that can be reached from one, numbered as they are found. `paid` has for each what is paid
    for its decrease, what a step that ends in it is paid, and whose decrease is progress; `within` how many
    states are found within 0, 1, ... steps. States that were found in the last step have no choices."""

    numbers: dict[GroundState, int]
    paid: list[tuple[N, N, N]]
    choices: list[tuple[Choice[N], ...]] = field(default_factory=list)
    within: list[int] = field(default_factory=lambda: [1])
    transitions: int = 0

    @property
    def number(self) -> int:
        """States found."""
        return len(self.numbers)

    def index(self, state: GroundState) -> int:
        """The number of a state; -1 where it was not found."""
        return self.numbers.get(state, -1)


@dataclass(frozen=True, slots=True)
class Worth(Generic[N]):
    """What the actions' payments are multiplied by, what comes after each is worth, and what a reward of 1 in
    each of 0, 1, ... steps is worth at their start; `preferred` tells which of two (values and earliness, see
    planning/preference.py) is better."""

    payments: Sequence[N]
    discounts: Sequence[N]
    idle: Sequence[N]
    preferred: Callable[[N, N, N, N], bool]


Step = tuple[Sequence[tuple[N, N]], Sequence[int]]
"""For each state that can be reached by a step: its value and earliness from then on, and what to do (-1 to
stop)."""


def may_be_small(task: Task) -> bool:
    """Whether it is worth while to look at the states of a task."""
    return len(task.rules) * task.horizon * FEW_STATES <= WORK


def small_graph(task: Task) -> PlainGraph[float] | None:
    """All that can be reached within the task's horizon; None where that would be too much work."""
    for graph in growing(task, float):
        if len(graph.choices) * len(task.rules) + task.horizon * graph.transitions > WORK:
            return None
    return graph


def small_policy(graph: PlainGraph[float], task: Task) -> list[Step[float]]:
    """What is best in each step, by machine numbers."""
    payments = [payment(task, action) for action in range(len(task.actions))]
    idle = idle_worth(task.discount, task.horizon).tolist()
    return backward(graph, task.horizon, Worth(payments, task.discounts, idle, preferred))


def growing(task: Task, number: Callable[[Fraction], N]) -> Iterator[PlainGraph[N]]:
    """The graph of all that can be reached within the horizon, which grows: as it is at first, and then after
    each state that is given its choices. `number` makes of a fraction what is calculated with."""
    paying = _paying(task, number)
    rules = [_rule(task, rule, number) for rule in task.rules]
    graph = PlainGraph({task.initial: 0}, [paying(task.initial)])
    yield graph
    for _ in range(task.horizon):
        frontier = list(graph.numbers)[len(graph.choices) :]
        for state in frontier:
            found = [_choice(graph, state, rule, paying) for rule in rules if holds(rule.condition, state)]
            stays = [graph.numbers[state]]
            graph.choices.append(
                tuple(each for each in found if task.waiting or [to for to, _ in each.after] != stays)
            )
            graph.transitions += sum(len(choice.after) for choice in graph.choices[-1])
            yield graph
        if frontier:
            graph.within.append(graph.number)


def backward(graph: PlainGraph[N], horizon: int, worth: Worth[N]) -> list[Step[N]]:
    """What is best in each step, from the first one on (planning/preference.py)."""
    steps: list[Step[N]] = []
    later: Sequence[tuple[N, N]] = ()
    for left in range(1, horizon + 1):
        known = graph.within[min(horizon - left, len(graph.within) - 1)]
        best = [_best(graph, state, left, later, worth) for state in range(known)]
        later = [each for each, _ in best]
        steps.append((later, [action for _, action in best]))
    return steps[::-1]


def _best(
    graph: PlainGraph[N], state: int, left: int, later: Sequence[tuple[N, N]], worth: Worth[N]
) -> tuple[tuple[N, N], int]:
    """The value of a state with so many steps left and its earliness, and the action that is best there (-1
    to stop)."""
    standing, action = graph.paid[state][1], -1
    value, earliness = standing * worth.idle[left], standing * idle_earliness(left)
    most = value
    for choice in graph.choices[state] if state < len(graph.choices) else ():
        expected, early = worth.idle[0], left * choice.progress
        for after, probability in choice.after if left > 1 else ():
            expected += probability * later[after][0]
            early += probability * later[after][1]
        total = worth.payments[choice.action] * choice.reward + worth.discounts[choice.action] * expected
        if worth.preferred(total, early, most, earliness):
            action, value, earliness = choice.action, total, early
        most = max(most, total)
    return (value, earliness), action


@dataclass(frozen=True, slots=True)
class _Rule(Generic[N]):
    """A rule of an action with what that costs, and the outcomes that can happen, each with its probability
    and with what it costs."""

    action: int
    cost: N
    condition: GroundCondition
    outcomes: tuple[tuple[N, N, tuple[tuple[int, int], ...]], ...]


def _rule(task: Task, rule: GroundRule, number: Callable[[Fraction], N]) -> _Rule[N]:
    outcomes = tuple(
        (number(o.probability), number(o.cost), o.effects) for o in rule.outcomes if o.probability
    )
    return _Rule(rule.action, number(task.actions[rule.action].cost), rule.condition, outcomes)


def _choice(
    graph: PlainGraph[N], state: GroundState, rule: _Rule[N], paying: Callable[[GroundState], tuple[N, N, N]]
) -> Choice[N]:
    """What comes of a rule in a state; adds the states that may follow."""
    decreasing, _, ahead = graph.paid[graph.numbers[state]]
    reward, progress, after = -rule.cost, rule.cost - rule.cost, dict[int, N]()
    for probability, cost, effects in rule.outcomes:
        following = changed(state, effects)
        successor = graph.numbers.setdefault(following, graph.number)
        if successor == len(graph.paid):
            graph.paid.append(paying(following))
        left, standing, still = graph.paid[successor]
        reward += probability * (decreasing - left + standing - cost)
        progress += probability * (ahead - still + standing)
        after[successor] = after[successor] + probability if successor in after else probability
    return Choice(rule.action, reward, progress, tuple(after.items()))


def _paying(task: Task, number: Callable[[Fraction], N]) -> Callable[[GroundState], tuple[N, N, N]]:
    """What tells of a state what `PlainGraph.paid` has."""
    goal, constant, nothing = set(task.goal), number(task.constant_reward), number(Fraction(0))
    wanted = [
        (each.condition, number(each.decrease), number(each.state), each.condition in goal)
        for each in asked(task)
    ]

    def paying(state: GroundState) -> tuple[N, N, N]:
        decreasing, standing, ahead = nothing, constant, nothing
        for condition, decrease, paid, is_goal in wanted:
            if holds(condition, state):
                decreasing += decrease
                standing += paid
                ahead += decrease - is_goal
        return decreasing, standing, ahead

    return paying
