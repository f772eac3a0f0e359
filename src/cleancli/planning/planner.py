"""What a planner is: a function that plans, and options of its own beside those of all planners."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Generic, TypeVar

from cleancli.planning.compiled_task import Prepared
from cleancli.planning.plan import Options, Plan, PlanningRefused

Own = TypeVar("Own")

Plans = Callable[[Prepared, Options], Plan]
"""Whatever plans: a planner with its options, or what stands for one."""


@dataclass(frozen=True, slots=True)
class Planner(Generic[Own]):
    """A planner by name; `own` are its own options, a dataclass of fields made by `option`. One that
    `reaches` can do without a horizon."""

    name: str
    search: Callable[[Prepared, Options, Own], Plan]
    own: Own
    reaches: bool = False

    def having(self, **own: object) -> Planner[Own]:
        """The planner with other values of some of its own options; TypeError where it has no such option."""
        changed: Own = replace(self.own, **own)  # type: ignore[type-var]  # a dataclass, see above
        return replace(self, own=changed)

    def __call__(self, prepared: Prepared, options: Options) -> Plan:
        """The plan, with the options of all planners and its own. Raises `PlanningRefused` where the problem
        has no horizon and the planner needs one."""
        if prepared.task.reaching is not None and not self.reaches:
            raise PlanningRefused(
                f"`{self.name}` plans up to a horizon, and this problem's is unlimited",
                "plan with `prada+` or `exact`, or state a number of actions: `horizon = 10`",
            )
        return self.search(prepared, options, self.own)
