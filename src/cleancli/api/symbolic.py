"""What is told of a situation in the symbolic world, which has no table: the domain's counts and the goal."""

from __future__ import annotations

from collections.abc import Callable

from cleancli.compiler.lifted_state import StateView
from cleancli.execution.episode_state import Situation
from cleancli.language.diagnostics.plural import plural
from cleancli.language.model import Domain, Problem

Told = Callable[[Situation], str]
"""What to say of a situation."""


def told_of(domain: Domain, problem: Problem) -> Told:
    """Says for example `dirty_areas 2, wet_areas 0; the goal does not hold`."""

    def told(situation: Situation) -> str:
        view = StateView(domain, (*domain.constants, *situation.objects), situation.state)
        counts = [
            f"{count.name} {sum(1 for _ in view.extensions(count.variables, count.condition, {}))}"
            for count in domain.counts
        ]
        text = ", ".join(counts) or plural(len(situation.state), "fact holds", "facts hold")
        if not problem.goal:
            return text
        return f"{text}; the goal {'holds' if view.holds(problem.goal, {}) else 'does not hold'}"

    return told
