"""What sequences and policies are worth: docs/planning.md once more, in slow and obvious Python.

A plan or policy acts, or stops, and stopping is final. Values are fractions where steps discount, and floats
where time does.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from fractions import Fraction

from support.differential.abstract import Action
from support.differential.interpreter import Call, Meaning, State

Number = Fraction | float
TIE = 1e-9
STOP = None


@dataclass(frozen=True, slots=True)
class Choice:
    """What is best to do: its value, how soon success comes (`soon`), and all choices that are as good."""

    value: Number
    soon: Number
    equals: tuple[Call | None, ...]


@dataclass(slots=True)
class Worth:
    meaning: Meaning
    by_time: bool = False
    discount: Number = field(init=False)
    step: float = field(init=False, default=1.0)
    choices: dict[tuple[State, int], Choice] = field(init=False, default_factory=dict)
    transitions: dict[tuple[State, Call], dict[State, Fraction]] = field(init=False, default_factory=dict)
    standings: dict[State, Fraction] = field(init=False, default_factory=dict)
    values_seen: dict[State, tuple[dict[str, int], bool]] = field(init=False, default_factory=dict)
    coverings: dict[State, tuple[Call, ...]] = field(init=False, default_factory=dict)
    calls: tuple[Call, ...] = field(init=False)

    def __post_init__(self) -> None:
        self.calls = self.meaning.calls()
        discount = Fraction(self.meaning.problem.discount or self.usual_discount())
        self.discount = float(discount) if self.by_time else discount
        if self.by_time:
            self.step = self.mean_duration()

    # ---- time

    def usual_discount(self) -> str:
        """Where the reward counts durations, nothing discounts unless the problem says so."""
        terms = [each.weight for each in self.meaning.domain.reward if each.kind == "duration"]
        return "1" if sum(terms) else "0.95"

    def duration(self, name: str) -> float:
        return float(self.seconds(self.meaning.actions[name]))

    def seconds(self, action: Action) -> Fraction:
        assert action.duration is not None
        number, unit = action.duration.split()
        return Fraction(number) * {"s": 1, "min": 60}[unit]

    def mean_duration(self) -> float:
        """Of the declared actions that some rule has an outcome with an effect for."""
        acting = [
            action.name
            for action in self.meaning.domain.actions
            if any(
                rule.action == action.name and any(outcome.effects for outcome in rule.outcomes)
                for rule in self.meaning.domain.rules
            )
        ]
        return sum(map(self.duration, acting)) / len(acting)

    def discount_of(self, call: Call) -> Number:
        if not self.by_time:
            return self.discount
        return self.discount ** (self.duration(call[0]) / self.step)

    def payment_of(self, call: Call) -> Number:
        """By time an action is paid when it is over, as a step of usual length would be."""
        return self.discount_of(call) / self.discount if self.by_time else Fraction(1)

    # ---- rewards

    def horizon(self, state: State) -> int:
        """As the problem says; otherwise one more than the first count that is to fall."""
        said = self.meaning.problem.horizon
        if said is None:
            name = next(
                payment.count
                for payment in self.meaning.domain.reward
                if payment.kind == "decrease" and payment.weight > 0
            )
            return 1 + self.meaning.counted(name, state)
        number, count = said
        return (number or 0) + (self.meaning.counted(count, state) if count is not None else 0)

    def what_is_paid_for(self, state: State) -> tuple[dict[str, int], bool]:
        """All counts, and whether the goal holds."""
        if state not in self.values_seen:
            counts = {name: self.meaning.counted(name, state) for name in self.meaning.counts}
            self.values_seen[state] = counts, self.goal(state)
        return self.values_seen[state]

    def goal(self, state: State) -> bool:
        goal = self.meaning.problem.goal
        return bool(goal) and self.meaning.all_hold(goal, state, {})

    def reward(self, before: State, call: Call, after: State, *, cost: bool = True) -> Fraction:
        """What a step is paid, but for what its outcome pays. Without `cost`, what it is paid for what it
        brings about."""
        counts, held = self.what_is_paid_for(before)
        counts_after, holds = self.what_is_paid_for(after)
        action = self.meaning.actions[call[0]]
        total = Fraction(0)
        for payment in self.meaning.domain.reward:
            paid: dict[str, Fraction | int] = {
                "decrease": counts.get(payment.count, 0) - counts_after.get(payment.count, 0),
                "count": counts_after.get(payment.count, 0),
                "goal": int(holds) - int(held),
                "cost": self.meaning.cost(call, before) if cost else 0,
                "duration": self.seconds(action) if action.duration is not None and cost else 0,
            }
            total += payment.weight * paid[payment.kind]
        return total

    def results(self, state: State, call: Call) -> list[tuple[Fraction, State, Fraction]]:
        """For each outcome its probability, the state after it, and the reward of the step."""
        covering = self.meaning.covering(call, state)
        if covering is None:
            return [(Fraction(1), state, self.reward(state, call, state))]
        rule, binding = covering
        weight = sum((each.weight for each in self.meaning.domain.reward if each.kind == "cost"), Fraction(0))
        found = []
        for outcome in rule.outcomes:
            if outcome.probability:
                after = self.meaning.after(outcome, binding, state)
                paid = self.meaning.price(outcome.reward, state, binding)
                paid += weight * self.meaning.price(outcome.cost, state, binding)
                found.append((outcome.probability, after, self.reward(state, call, after) + paid))
        return found

    def paid_by_outcome(self, state: State, call: Call) -> Fraction:
        """What is expected of which outcome happens, beside what the states say."""
        after = self.after(state, call).items()
        by_states = sum((chance * self.reward(state, call, there) for there, chance in after), Fraction(0))
        return self.expected(state, call) - by_states

    def standing(self, state: State) -> Fraction:
        """What a state is paid for each step in which nothing is done."""
        if state not in self.standings:
            self.standings[state] = sum(
                (
                    payment.weight * self.meaning.counted(payment.count, state)
                    for payment in self.meaning.domain.reward
                    if payment.kind == "count"
                ),
                Fraction(0),
            )
        return self.standings[state]

    def stopped(self, state: State, left: int) -> Number:
        discount = self.discount
        return self.standing(state) * sum((discount**step for step in range(left)), start=discount * 0)

    # ---- sequences

    def after(self, state: State, call: Call) -> dict[State, Fraction]:
        if (state, call) not in self.transitions:
            self.transitions[state, call] = self.meaning.successors(call, state)
        return self.transitions[state, call]

    def expected(self, state: State, call: Call) -> Fraction:
        return sum((chance * paid for chance, _, paid in self.results(state, call)), Fraction(0))

    def of_sequence(self, calls: Sequence[Call], state: State | None = None) -> Number:
        """What the actions are worth, up to the horizon, and then nothing is done."""
        state = self.meaning.initial() if state is None else state
        horizon = self.horizon(state)
        distribution: dict[State, Fraction] = {state: Fraction(1)}
        worth: Number = self.discount * 0
        weight: Number = self.discount * 0 + 1
        for call in calls[:horizon]:
            gained = sum(
                (chance * self.expected(here, call) for here, chance in distribution.items()), Fraction(0)
            )
            worth += weight * self.payment_of(call) * gained
            weight *= self.discount_of(call)
            distribution = self.spread(distribution, call)
        left = max(horizon - len(calls), 0)
        return worth + weight * sum(
            (chance * self.stopped(here, left) for here, chance in distribution.items()),
            start=self.discount * 0,
        )

    def spread(self, distribution: dict[State, Fraction], call: Call) -> dict[State, Fraction]:
        after: dict[State, Fraction] = {}
        for here, chance in distribution.items():
            for there, share in self.after(here, call).items():
                after[there] = after.get(there, Fraction(0)) + chance * share
        return after

    # ---- the best

    def choice(self, state: State, left: int) -> Choice:
        """What is best with so many steps left, found from the last step backwards."""
        if (state, left) not in self.choices:
            self.choices[state, left] = self.chosen(state, left)
        return self.choices[state, left]

    def chosen(self, state: State, left: int) -> Choice:
        if left == 0:
            return Choice(self.discount * 0, Fraction(0), (STOP,))
        waited = self.standing(state) * sum(range(1, left + 1))
        weighed: list[tuple[Number, Number, Call | None]] = [(self.stopped(state, left), waited, STOP)]
        weighed += [(*self.acted(state, call, left), call) for call in self.covered(state)]
        value = max(each[0] for each in weighed)
        best = [each for each in weighed if each[0] >= value - TIE]
        soon = max(each[1] for each in best)
        equals = tuple(each[2] for each in best if each[1] >= soon - TIE)
        if STOP in equals:
            equals = (STOP,)
        return Choice(value, soon, equals)

    def covered(self, state: State) -> tuple[Call, ...]:
        if state not in self.coverings:
            self.coverings[state] = tuple(
                call for call in self.calls if self.meaning.covering(call, state) is not None
            )
        return self.coverings[state]

    def acted(self, state: State, call: Call, left: int) -> tuple[Number, Number]:
        value: Number = self.discount * 0 + self.payment_of(call) * self.paid_by_outcome(state, call)
        soon: Number = Fraction(0)
        for there, chance in self.after(state, call).items():
            then = self.choice(there, left - 1)
            value += chance * (
                self.payment_of(call) * self.reward(state, call, there) + self.discount_of(call) * then.value
            )
            soon += chance * (left * self.progress(state, call, there) + then.soon)
        return value, soon

    def progress(self, before: State, call: Call, after: State) -> Fraction:
        reached = int(self.goal_seen(after)) - int(self.goal_seen(before))
        return self.reward(before, call, after, cost=False) + reached

    def goal_seen(self, state: State) -> bool:
        return self.what_is_paid_for(state)[1]
