"""The optimal policy in exact arithmetic: fractions from the rule file to the value, in plain Python."""

from __future__ import annotations

from fractions import Fraction
from itertools import accumulate

from cleancli.compiler.task import GroundState, Task
from cleancli.planning.plan import TooManyStatesError
from cleancli.planning.planners.plain_graph import Worth, backward, growing
from cleancli.planning.trajectory import Choose


def optimum(task: Task, limit: int) -> tuple[Fraction, Choose]:
    """The optimal value of the initial state, and the policy, as planning/kernels/state_graph.py has them in
    floats.

    A discount, which is a float, is taken for the decimal number that it is printed as. Raises
    `TooManyStatesError` where more than `limit` states can be reached within the horizon.
    """
    for graph in growing(task, Fraction):
        if graph.number > limit:
            raise TooManyStatesError(graph.number, limit)
    steps = backward(graph, task.horizon, _worth(task))

    def choose(step: int, state: GroundState) -> int | None:
        action = steps[step][1][graph.index(state)]
        return action if action >= 0 else None

    return steps[0][0][0][0] if steps else Fraction(0), choose


def _worth(task: Task) -> Worth[Fraction]:
    discount, discounts = Fraction(repr(task.discount)), [Fraction(repr(d)) for d in task.discounts]
    payments = [d / discount if discount else Fraction(1) for d in discounts]
    idle = accumulate((discount**step for step in range(task.horizon)), initial=Fraction(0))
    return Worth(payments, discounts, list(idle), lambda v, e, w, f: (v, e) > (w, f))
