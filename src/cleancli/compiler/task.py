"""The grounded task: a finite, factored decision process in plain tuples.

Guaranteed by `ground`: everything is sorted; a variable is a symbol's value for some objects that at least
one outcome can change (all others were decided when grounding); rules of one action exclude each other, so at
most one covers a state (§3.3.2), unless they were grounded as libPRADA does; an action none of whose rules
can change anything is listed only where `waiting` says so, or where it was asked for by name.
"""

from __future__ import annotations

import enum
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction

from cleancli.language.model import OutcomeKind, Value


@dataclass(frozen=True, slots=True, order=True)
class StateVariable:
    """A symbol for some objects, with its values in declared order."""

    symbol: str
    objects: tuple[str, ...]
    values: tuple[Value, ...]


GroundLiteral = tuple[int, frozenset[int]]
"""A variable's index, and the indices of the values that it may have."""

GroundCondition = tuple[GroundLiteral, ...]
"""Sorted by variable, one literal a variable."""

GroundState = tuple[int, ...]
"""A state of the task: for each variable the index of its value."""


@dataclass(frozen=True, slots=True, order=True)
class GroundAction:
    """An action for some objects; `duration` in seconds, None where the domain does not say; `cost` is what
    the reward of a step loses by it and by how long it lasts, `declared_cost` what the domain says that it
    costs."""

    name: str
    objects: tuple[str, ...]
    duration: float | None
    cost: Fraction = Fraction(0)
    declared_cost: Fraction = Fraction(0)

    @property
    def key(self) -> tuple[str, tuple[str, ...]]:
        """What tells it from all others of its domain and problem."""
        return self.name, self.objects

    def __str__(self) -> str:
        return f"{self.name}({', '.join(self.objects)})"


@dataclass(frozen=True, slots=True)
class GroundOutcome:
    """`effects` are pairs (variable, value index), sorted; empty for noise and for nothing. `cost` is what
    the reward of a step loses by the outcome, `declared_cost` what the domain says that it costs, both beside
    those of the action."""

    probability: Fraction
    kind: OutcomeKind
    effects: tuple[tuple[int, int], ...]
    cost: Fraction = Fraction(0)
    declared_cost: Fraction = Fraction(0)


@dataclass(frozen=True, slots=True)
class GroundRule:
    """A rule for the objects of `action` (an index). `rule` is the rule's index in the domain; outcomes keep
    the domain's order."""

    rule: int
    action: int
    condition: GroundCondition
    outcomes: tuple[GroundOutcome, ...]

    @property
    def changes(self) -> bool:
        """Whether one of its outcomes has an effect."""
        return any(outcome.effects for outcome in self.outcomes)

    @property
    def pays(self) -> bool:
        """Whether one of its outcomes costs or earns something."""
        return any(outcome.cost or outcome.declared_cost for outcome in self.outcomes)

    @property
    def declared_cost(self) -> Fraction:
        """What its outcomes cost on average, by what the domain says."""
        parts = (each.probability * each.declared_cost for each in self.outcomes if each.declared_cost)
        return sum(parts, Fraction(0))


@dataclass(frozen=True, slots=True)
class RewardCondition:
    """What a condition pays: `decrease` when it ends (and loses when it begins), `state` after each step in
    which it holds."""

    condition: GroundCondition
    decrease: Fraction
    state: Fraction


class Objective(enum.Enum):
    """What is to be greatest or least. Up to a horizon: the reward, where steps discount or where time does.
    Without one: the probability of the goal, and then what it takes to reach it: actions, costs or time."""

    REWARD = "reward"
    TIME = "time"
    COST = "cost"
    PROBABILITY = "probability"


@dataclass(frozen=True, slots=True)
class Reaching:
    """What planning is for without a horizon: first that the goal is reached, whenever that is, and then that
    it costs little until then; `costs` are those of the actions by the objective, 0 or more each."""

    objective: Objective
    costs: tuple[Fraction, ...]

    def by_outcome(self, rule: GroundRule) -> Fraction:
        """What the outcomes of a rule cost on average beside its action."""
        return rule.declared_cost if self.objective is Objective.COST else Fraction(0)


def reaching_by(objective: Objective, actions: Sequence[GroundAction]) -> Reaching:
    """What counts without a horizon by an objective. By time all actions have durations. A reward counts up
    to a horizon alone."""
    match objective:
        case Objective.PROBABILITY:
            costs = (Fraction(1),) * len(actions)
        case Objective.COST:
            costs = tuple(action.declared_cost for action in actions)
        case Objective.TIME:
            costs = tuple(in_seconds(action.duration) for action in actions)
        case Objective.REWARD:
            raise ValueError("a reward is summed up to a horizon")
    return Reaching(objective, costs)


def in_seconds(duration: float | None) -> Fraction:
    """A duration as an exact number: a float counts as the decimal number that it is printed as. One that is
    not known counts nothing."""
    return Fraction(0) if duration is None else Fraction(repr(duration))


@dataclass(frozen=True, slots=True)
class Task:
    """A grounded problem.

    The reward of a step is what `rewards` pay, plus `constant_reward`, less the costs of the action and of
    the outcome that happens; a step after
    the end of a plan is paid in the same way, and costs nothing. The conditions of `goal` exclude each other,
    and one of them holds where the goal does; there are none without a goal, or where it can never hold. As
    many conditions of `counted` hold as the count says that eq. 2 wants decreased (#dirt of eq. 3); None
    where the reward decreases none. The horizon is the initial state's; as many conditions of `lengthening`
    hold as it has steps for a count (§4.2.2).

    What comes after an action is worth `discounts` of it times less, per action; after a step in which
    nothing is done, `discount` times (§3.3, where the text writes α for γ). `step` is how many seconds such a
    step stands for where time discounts: the mean duration of the domain's actions with a rule that has an
    effect, whatever occurs in the problem. It is None where the actions of `untimed` have no duration.
    `price` is what a second of an action costs; the costs of the actions have it in them.

    `waiting`: standing still can pay, so an action that changes nothing is a choice like others where a rule
    covers it; otherwise it is never better than what comes next, and planners leave it out.

    Where the problem has no horizon, `reaching` is what counts; `horizon` is 0 then, and no reward counts.

    In states of which a condition of `unreachable` holds, rules may be missing. From `initial`, and from each
    state in which none holds, actions lead only to states in which none does.
    """

    variables: tuple[StateVariable, ...]
    initial: GroundState
    actions: tuple[GroundAction, ...]
    rules: tuple[GroundRule, ...]
    rewards: tuple[RewardCondition, ...]
    constant_reward: Fraction
    goal: tuple[GroundCondition, ...]
    counted: tuple[GroundCondition, ...] | None
    lengthening: tuple[GroundCondition, ...]
    horizon: int
    discount: float
    discounts: tuple[float, ...]
    step: float | None
    untimed: tuple[str, ...]
    waiting: bool
    reaching: Reaching | None = None
    price: Fraction = Fraction(0)
    unreachable: tuple[GroundCondition, ...] = ()

    @property
    def steps(self) -> int | None:
        """The horizon; None where the problem has none."""
        return self.horizon if self.reaching is None else None


def holds(condition: GroundCondition, assignment: GroundState) -> bool:
    """Whether the assignment gives every variable of the condition one of the values it may have."""
    return all(assignment[variable] in allowed for variable, allowed in condition)


def is_unreachable(task: Task, assignment: GroundState) -> bool:
    """Whether the task may lack rules that cover a state, because no actions lead to it."""
    return any(holds(condition, assignment) for condition in task.unreachable)


def variables_of(condition: GroundCondition) -> list[int]:
    """The variables that the condition asks for, ascending."""
    return [variable for variable, _ in condition]


def held(conditions: Sequence[GroundCondition], assignment: GroundState) -> int:
    """How many of the conditions hold."""
    return sum(holds(condition, assignment) for condition in conditions)


def asked(task: Task) -> tuple[RewardCondition, ...]:
    """What the reward asks, and then what only the goal asks, which pays nothing."""
    named = {reward.condition for reward in task.rewards}
    others = [condition for condition in task.goal if condition and condition not in named]
    return (*task.rewards, *(RewardCondition(condition, Fraction(0), Fraction(0)) for condition in others))


def advances(task: Task) -> tuple[float, ...]:
    """How much of a step's progress (compiler/semantics.py) the end of each condition of `asked` is."""
    goal = set(task.goal)
    return tuple(float(reward.decrease) - (reward.condition in goal) for reward in asked(task))


def in_state(task: Task, assignment: GroundState) -> Task:
    """The same task from another state on, with the horizon that it has there."""
    change = held(task.lengthening, assignment) - held(task.lengthening, task.initial)
    return replace(task, initial=assignment, horizon=task.horizon + change)


def without(task: Task, excluded: Collection[tuple[str, tuple[str, ...]]]) -> Task:
    """The same task without the actions of these names and objects, and without their rules."""
    kept = [i for i, action in enumerate(task.actions) if action.key not in excluded]
    if len(kept) == len(task.actions):
        return task
    new = {old: index for index, old in enumerate(kept)}
    reaching = task.reaching
    if reaching is not None:
        reaching = replace(reaching, costs=tuple(reaching.costs[i] for i in kept))
    return replace(
        task,
        reaching=reaching,
        actions=tuple(task.actions[i] for i in kept),
        rules=tuple(replace(rule, action=new[rule.action]) for rule in task.rules if rule.action in new),
        discounts=tuple(task.discounts[i] for i in kept),
    )


def by_time(task: Task) -> Task:
    """The same task where time discounts and not the number of steps (a semi-Markov process).

    An action's discount is γ to the power of its duration over `step`: so values keep their scale, and it
    depends on nothing that is planned or asked for. Raises `NoDurationError` where a duration is not known.
    """
    if task.untimed:
        raise NoDurationError(task.untimed)
    if task.step is None:  # the domain has no actions
        return task
    seconds = [action.duration for action in task.actions if action.duration is not None]
    assert len(seconds) == len(task.actions)
    return replace(task, discounts=tuple(task.discount ** (each / task.step) for each in seconds))


def lasting(task: Task, seconds: Mapping[tuple[str, tuple[str, ...]], float]) -> Task:
    """The same task where an action, by its key, lasts so many seconds on its objects, and costs what these
    cost; others last as long as the domain says. `step` is then the mean of all: over actions on objects,
    and not over names."""
    if not seconds:
        return task
    actions = tuple(_lasting(each, seconds.get(each.key, each.duration), task.price) for each in task.actions)
    known = [action.duration for action in actions if action.duration is not None]
    untimed = sorted({action.name for action in actions if action.duration is None})
    step = sum(known) / len(known) if known and not untimed else None
    return replace(task, actions=actions, step=step, untimed=tuple(untimed))


def _lasting(action: GroundAction, seconds: float | None, price: Fraction) -> GroundAction:
    longer = in_seconds(seconds) - in_seconds(action.duration)
    return replace(action, duration=seconds, cost=action.cost + price * longer)


class NoDurationError(ValueError):
    """Time counts, as `wanted` says, and the domain says of some `actions` (names) no duration."""

    def __init__(self, actions: Sequence[str], wanted: str = "time is to discount") -> None:
        super().__init__(f"no duration: {', '.join(actions)}")
        self.actions = tuple(actions)
        self.wanted = wanted


def horizon_text(steps: int | None) -> str:
    """A horizon as a problem writes it, None for one without a limit."""
    return "unlimited" if steps is None else str(steps)


def condition_order(condition: GroundCondition) -> tuple[tuple[int, tuple[int, ...]], ...]:
    """A sort key for conditions; sets of values have no order of their own."""
    return tuple((variable, tuple(sorted(allowed))) for variable, allowed in condition)


def literal_text(variable: StateVariable, allowed: Iterable[int]) -> str:
    """A literal as a rule file would write it, like `not dirt(a1)` or `size(a1) = small | medium`."""
    values = [variable.values[index] for index in sorted(allowed)]
    subject = f"{variable.symbol}({', '.join(variable.objects)})"
    if len(values) == 1 and isinstance(values[0], bool):
        return subject if values[0] else f"not {subject}"
    return f"{subject} = {' | '.join(map(str, values))}"
