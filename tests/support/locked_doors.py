"""Doors that can be pushed, unlocked and bolted: a vocabulary with a place for rules, its rules, and a
problem."""

from __future__ import annotations

VOCABULARY = """\
domain doors {
  types      { door }
  predicates { open(?d - door)  locked(?d - door) }
  derived    { shut := count ?d - door: not open(?d) }
  actions    { push(?d - door)  unlock(?d - door)  bolt(?d - door) }
  %s
  reward     { decrease(shut) }
}
"""
RULES = """
  rule push: push(?d) { when not locked(?d), not open(?d) then 0.8: open(?d) 0.2: nothing }
  rule unlock: unlock(?d) { when locked(?d) then 1: not locked(?d) }
  rule bolt: bolt(?d) { when not open(?d), not locked(?d) then 1: locked(?d) }
"""
PROBLEM = """\
problem p {
  domain = doors
  objects { a b c - door }
  init { locked(a) }
  goal { forall ?d - door: open(?d) }
  horizon = 8
}
"""
