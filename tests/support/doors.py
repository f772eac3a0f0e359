"""Small domains and planners that always say the same, for the tests of the symbolic world."""

from __future__ import annotations

from collections.abc import Sequence

from cleancli.compiler.task import GroundAction
from cleancli.language.model import Domain, Problem
from cleancli.planning.compiled_task import Prepared
from cleancli.planning.plan import Options, Plan
from cleancli.planning.planner import Plans
from support import from_text

DOORS = """
domain doors {
  types      { door }
  predicates { open(?d - door) jammed(?d - door) }
  functions  { force(?d - door): 1..3 }
  derived    { shut := count ?d - door: not open(?d)  opened := count ?d - door: open(?d) }
  actions    { push(?d - door) [duration = 4 s, cost = 1]  oil(?d - door) [duration = 10 s] }
  rule push_it: push(?d) {
    when not open(?d), not jammed(?d)
    then 0.6: open(?d)
         0.4: nothing
  }
  rule oil_it: oil(?d) {
    when not open(?d)
    then 0.5: open(?d)
         rest: noise
  }
  reward { decrease(shut) }
}
"""

JAMMING = DOORS.replace("0.4: nothing", "0.4: jammed(?d), force(?d) += 1").replace("doors", "jamming", 1)
"""The same, but that doors may get stuck where the other rules know nothing of it."""

PAID = DOORS.replace("reward { decrease(shut) }", "reward { 0.5 * opened - 0.2 * cost }")
"""The same, but that open doors pay in each step, and pushing costs."""

PULLED = """domain doors {
  types { door }
  predicates { open(?d - door) }
  derived { shut := count ?d - door: not open(?d) }
  actions { push(?d - door) [duration = 1 s] pull(?d - door) [duration = 1 s] }
  rule pushed: push(?d) { when not open(?d) then %s: open(?d) rest: nothing }
  rule pulled: pull(?d) { when not open(?d) then 0.4: open(?d) rest: nothing }
  reward { decrease(shut) }
}
"""
"""Doors that may be pulled, too; `%` says how likely a push opens one."""

STORMY = DOORS.replace("oil(?d - door) [", "storm() [duration = 2 s, cost = 3]  oil(?d - door) [").replace(
    "  reward",
    """  rule storm_in: storm() {
    when exists ?d - door: not open(?d)
    then 0.3: forall ?d - door => open(?d)
         0.7: nothing
  }
  reward""",
)
"""The same with an action without parameters."""

TWO_DOORS = "init { force(a) = 1, force(b) = 1 }"


def problem(known: Domain, inside: str = TWO_DOORS) -> Problem:
    """A problem with two doors."""
    return from_text.problem(known, f"objects {{ a b - door }} {inside}")


def saying(*actions: str) -> Plans:
    """A planner that always says the same actions, written like `push(a)` or `storm()`."""
    calls = [text.removesuffix(")").split("(") for text in actions]
    said = tuple(GroundAction(name, (argument,) if argument else (), None) for name, argument in calls)

    def planner(prepared: Prepared, options: Options) -> Plan:
        return plan(prepared, said)

    return planner


def plan(prepared: Prepared, actions: Sequence[GroundAction]) -> Plan:
    return Plan("said", tuple(actions), 0.0, "exact", 0, prepared.task.horizon, None, {})
