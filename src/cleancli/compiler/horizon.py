"""How many actions a problem's plans have in its initial state, without grounding it (§4.2.2)."""

from __future__ import annotations

from cleancli.compiler.lifted_state import StateView
from cleancli.language.model import Domain, Horizon, Problem, Unlimited, wanted_decreased


def first_horizon(domain: Domain, problem: Problem) -> int:
    """The horizon of a problem in its initial state, as the task that it is grounded to has it; 0 where that
    is unlimited."""
    horizon = problem.horizon or Horizon(1, wanted_decreased(domain))
    if isinstance(horizon, Unlimited):
        return 0
    count = next((each for each in domain.counts if each.name == horizon.count), None)
    if count is None:
        return horizon.constant
    view = StateView(domain, problem.objects, problem.state)
    return horizon.constant + sum(1 for _ in view.extensions(count.variables, count.condition, {}))
