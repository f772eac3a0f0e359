"""Domains whose conditional effects have many cases of which few are of states that are reached."""

from __future__ import annotations

import itertools

from support import from_text

PACKETS = """
domain packets {
  types      { packet }
  predicates { three(?p - packet)  two(?p - packet)  one(?p - packet)  none(?p - packet)  dropped(?p - packet)
               due() }
  derived    { lost := count ?p - packet: dropped(?p) }
  actions    { send(?p - packet)  reclaim(?p - packet)  tick() }
  rule send: send(?p) { when not due(), not three(?p) then 0.9: three(?p), due() rest: due() }
  rule reclaim: reclaim(?p) {
    when due()
    then 1: not three(?p), not two(?p), not one(?p), not none(?p), not dropped(?p)
  }
  rule tick: tick() {
    when due()
    then 1: not due(), forall ?p - packet: none(?p) => dropped(?p), forall ?p - packet: one(?p) => none(?p),
            forall ?p - packet: two(?p) => one(?p), forall ?p - packet: three(?p) => two(?p)
  }
  reward     { decrease(lost) }
}
"""
"""What is left of a packet's time is said by up to four facts, of which each has all before it."""

BLOCKS = """
domain blocks {
  types      { block }
  predicates { on(?a ?b - block)  held(?a - block)  spent(?a - block)  gone(?a - block) }
  derived    { lost := count ?a - block: gone(?a) }
  actions    { take(?a - block)  put(?a ?b - block) }
  rule take: take(?a) {
    when not gone(?a), not exists ?x - block: on(?x, ?a), not exists ?x - block: held(?x)
    then 1: held(?a), forall ?x - block: on(?a, ?x) => not on(?a, ?x)
  }
  rule put: put(?a, ?b) {
    when held(?a), not gone(?b), not spent(?a), ?a != ?b, not exists ?x - block: on(?x, ?b)
    then 0.7: not held(?a), on(?a, ?b)
         0.3: not held(?a), spent(?a), gone(?b), forall ?x - block: on(?b, ?x) => (not on(?b, ?x), on(?a, ?x))
  }
  rule put_spent: put(?a, ?b) {
    when held(?a), not gone(?b), spent(?a), ?a != ?b, not exists ?x - block: on(?x, ?b)
    then 1: not held(?a), on(?a, ?b)
  }
  reward     { decrease(lost) }
}
"""
"""A block that is put on another may blow it up, and then lies on what that lay on: at most one block."""

DISKS = """
domain disks {
  types      { disk; rod }
  constants  { here - rod }
  predicates { on(?a ?b - disk)  at(?a - disk ?r - rod)  larger(?a ?b - disk)  failed() }
  derived    { clear(?a - disk) := not exists ?x - disk: on(?x, ?a)
               misplaced := count ?a - disk: at(?a, here) }
  actions    { move(?a - disk ?from ?to - rod) }
  rule move: move(?a, ?from, ?to) {
    when at(?a, ?from), clear(?a), ?from != ?to, not failed(),
         not exists ?x - disk: (at(?x, ?to), larger(?a, ?x))
    then 0.9: not at(?a, ?from), at(?a, ?to), forall ?x - disk: on(?a, ?x) => not on(?a, ?x),
              forall ?x - disk: at(?x, ?to), clear(?x), ?x != ?a => on(?a, ?x)
         0.1: failed()
  }
  reward     { decrease(misplaced) }
}
"""
"""The disk that is moved comes to lie on that with nothing on it."""

LAMPS = """
domain lamps {
  types      { lamp }
  predicates { lit(?x - lamp)  used(?x - lamp) }
  derived    { unused := count ?x - lamp: not used(?x) }
  actions    { light(?x - lamp)  stop() }
  rule light: light(?x) { then 1: lit(?x), forall ?y - lamp: ?y != ?x => not lit(?y) }
  rule stop: stop() { then 0.5: forall ?x - lamp: lit(?x) => (not lit(?x), used(?x)) rest: nothing }
  reward     { decrease(unused) }
}
"""
"""At most one lamp is lit, unless more are from the beginning."""

LAMP_NAMES = tuple(f"l{number:02d}" for number in range(11))

MANY_LAMPS = from_text.domain(LAMPS)
NONE_LIT = from_text.problem(MANY_LAMPS, f"objects {{ {' '.join(LAMP_NAMES)} - lamp }} horizon = 5")
"""So many lamps that what happens to each has 2,048 cases together."""


def packets(number: int) -> str:
    """A problem's inside: none is on its way."""
    return f"objects {{ {' '.join(f'p{n}' for n in range(number))} - packet }} init {{ due() }} horizon = 5"


def blocks(number: int) -> str:
    """A problem's inside: half of them in a tower."""
    names = [f"b{n:02d}" for n in range(number)]
    tower = " ".join(f"on({a}, {b})" for a, b in itertools.pairwise(names[: number // 2]))
    return f"objects {{ {' '.join(names)} - block }} init {{ {tower} }} horizon = 5"


def disks(number: int) -> str:
    """A problem's inside: all on one rod, the smallest first."""
    names = [f"d{n}" for n in range(number)]
    tower = " ".join(f"on({a}, {b})" for a, b in itertools.pairwise(names))
    larger = " ".join(f"larger({b}, {a})" for n, b in enumerate(names) for a in names[:n])
    here = " ".join(f"at({a}, here)" for a in names)
    objects = f"{' '.join(names)} - disk  mid there - rod"
    return f"objects {{ {objects} }} init {{ {here} {tower} {larger} }} horizon = 5"
