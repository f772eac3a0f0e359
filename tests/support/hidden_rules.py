"""Small domains whose rules are to be found from experience alone, and states to begin walks in."""

from __future__ import annotations

import itertools
from collections.abc import Mapping

import numpy as np

from cleancli.compiler.fluents import Fluent
from cleancli.language.diagnostics.diagnostic import Source
from cleancli.language.load import load_domain
from cleancli.language.model import Domain, Object, Value
from support.walks import Start

TEXTS = {
    "locks": """\
domain locks {
  types      { door; key }
  predicates {
    open(?d - door)  jammed(?d - door)  held(?k - key)  bent(?k - key)
    fits(?k - key, ?d - door) [static]
  }
  derived    { shut := count ?d - door: not open(?d) }
  actions    { unlock(?d - door) grab(?k - key) slam(?d - door) }
  rule unlock: unlock(?d) {
    when not jammed(?d), not open(?d)
    with ?k - key: held(?k), fits(?k, ?d)
    then 0.7: open(?d)
         0.2: bent(?k), not held(?k)
         0.1: nothing
  }
  rule grab: grab(?k) {
    when not bent(?k), not exists ?z - key: held(?z)
    then 0.9: held(?k)
         0.1: nothing
  }
  rule slam_open: slam(?d) {
    when open(?d), not jammed(?d)
    then 0.8: not open(?d)
         0.2: not open(?d), jammed(?d)
  }
  rule slam_jammed: slam(?d) {
    when jammed(?d)
    then 0.3: not jammed(?d)
         0.7: nothing
  }
  reward { decrease(shut) }
}
""",
    "lift": """\
domain lift {
  types      { person }
  predicates { inside(?p - person)  vip(?p - person) [static] }
  functions  { floor(): 0..6  load(): 0..4  level(?p - person): 0..6 [static] }
  derived    { waiting := count ?p - person: not inside(?p) }
  actions    { up() down() leap() board(?p - person) leave(?p - person) }
  rule up: up() {
    when load() <= 3, floor() < 6
    then 0.9: floor() += 1
         0.1: nothing
  }
  rule down: down() {
    then 0.8: floor() -= 1
         0.2: floor() -= 2
  }
  rule leap: leap() {
    when load() = 0
    then 1: floor() := 6
  }
  rule board: board(?p) {
    when not inside(?p), load() < 4
    then 0.9: inside(?p), load() += 1
         0.1: nothing
  }
  rule leave: leave(?p) {
    when inside(?p), floor() >= 2
    then 1: not inside(?p), load() -= 1
  }
  reward { decrease(waiting) }
}
""",
    "weather": """\
domain weather {
  types      { town; umbrella }
  predicates {
    raining(?t - town)  beside(?a ?b - town) [symmetric, static]
    at(?u - umbrella, ?t - town)  spread(?u - umbrella)  torn(?u - umbrella)
  }
  derived    {
    dry := count ?t - town: not raining(?t)
    sheltered(?t - town) := exists ?u - umbrella: (at(?u, ?t), spread(?u))
  }
  actions    { gust(?t - town) unfold(?u - umbrella) carry(?u - umbrella, ?t - town) }
  rule gust_rain: gust(?t) {
    when raining(?t)
    then 0.6: forall ?u - umbrella: at(?u, ?t), spread(?u) => (not spread(?u), torn(?u))
         0.3: not raining(?t), forall ?o - town: beside(?t, ?o) => raining(?o)
         0.1: nothing
  }
  rule gust_dry: gust(?t) {
    when not raining(?t), not sheltered(?t)
    then 0.5: raining(?t)
         0.5: nothing
  }
  rule unfold: unfold(?u) {
    when not torn(?u), exists ?t - town: (at(?u, ?t), raining(?t))
    then 0.9: spread(?u)
         0.1: torn(?u)
  }
  rule carry: carry(?u, ?t) {
    when not spread(?u)
    with ?f - town: at(?u, ?f), beside(?f, ?t)
    then 0.95: not at(?u, ?f), at(?u, ?t)
         0.05: nothing
  }
  reward { decrease(dry) }
}
""",
}
"""References, exclusion by quantifiers and by negation; shifts that stop at bounds, comparisons, and a number
that is always the same after; `forall` with guards of two literals, and a derived predicate."""

MOST_OBJECTS: Mapping[str, Mapping[str, int]] = {
    "locks": {"door": 3, "key": 4},
    "lift": {"person": 4},
    "weather": {"town": 4, "umbrella": 3},
}


def domain_of(name: str) -> Domain:
    """A domain with the rules that are to be found."""
    return load_domain(Source(f"{name}.nid", TEXTS[name]))


def starts(name: str, rng: np.random.Generator, number: int = 60) -> list[Start]:
    """Random states of a domain; an umbrella is in one town."""
    domain = domain_of(name)
    return [_start(domain, MOST_OBJECTS[name], rng) for _ in range(number)]


def _start(domain: Domain, most: Mapping[str, int], rng: np.random.Generator) -> Start:
    numbers = {name: int(rng.integers(max(count - 2, 1), count + 1)) for name, count in most.items()}
    objects = tuple(
        Object(f"{name}{index + 1}", name) for name, count in numbers.items() for index in range(count)
    )
    values: dict[Fluent, Value] = {}
    for symbol in domain.symbols:
        among = [[o.name for o in objects if o.type == p.type] for p in symbol.parameters]
        for names in itertools.product(*among):
            if symbol.symmetric and names[0] >= names[1]:
                continue
            if not symbol.is_predicate:
                values[symbol.name, names] = symbol.values[int(rng.integers(len(symbol.values)))]
            elif rng.random() < 0.4:
                values[symbol.name, names] = True
    if domain.name == "weather":
        values = {key: value for key, value in values.items() if key[0] != "at"}
        towns = [thing.name for thing in objects if thing.type == "town"]
        for thing in objects:
            if thing.type == "umbrella":
                values["at", (thing.name, towns[int(rng.integers(len(towns)))])] = True
    return objects, values
