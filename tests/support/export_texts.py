"""Domains and a problem that are written in other languages."""

EVERYTHING = """
domain everything {
  types      { thing; box - thing; crate - box; shelf - thing; place }
  constants  { home - place  first - crate }
  predicates {
    wet(?t - thing)
    open(?b - box)
    near(?a ?b - thing) [symmetric]
    under(?a ?b - thing) [static]
    at(?t - thing, ?p - place)
    alarm()
  }
  functions  {
    size(?t - thing): small < medium < big
    load(?b - box): -1..3
    total(): 0..5
    kind(?b - box): paper < glass [static]
    far(?a ?b - box): 0..4 [static]
    toll(): 1..3 [static]
  }
  derived {
    below(?a ?b - thing)  := closure under
    joined(?a ?b - thing) := closure near
    dry(?t - thing)       := not wet(?t)
    lonely(?t - thing)    := not exists ?o - thing: near(?t, ?o), dry(?t)
    wets                  := count ?t - thing: wet(?t)
    heavy                 := count ?b - box: load(?b) >= 2, size(?b) != small, not lonely(?b)
    damp  := count ?t - thing ?p - place: at(?t, ?p), forall ?o - thing: near(?t, ?o) => wet(?o)
  }
  parameters { half = 0.5 }
  actions {
    push(?a ?b - box)   [duration = 2.5 s, cost = 2 + 1/3 * far(?a, ?b) + 2 * far(?b, first) + toll()]
    rinse(?t - thing)   [duration = 4 s, cost = toll()]
    ring()              [duration = 1 s]
  }
  rule push_loaded: push(?a, ?b) {
    when load(?a) >= 1, not alarm(), kind(?b) = paper, toll() != 3, exists ?s - shelf: below(?a, ?s)
    then half: load(?a) += 2, load(?b) -= 1, load(first) += 1, reward += 2.5
         0.25: size(?a) := small, near(?a, ?b), if ?a != ?b, wet(?a) => (not wet(?a), wet(?b))
         1/8:  if wet(?a) => not wet(?a), if dry(?a) => wet(?a), forall ?o - box: near(?a, ?o) => at(?o, home)
         rest: noise
  }
  rule push_light: push(?a, ?b) {
    when load(?a) < 1, not alarm(), ?a != ?b
    with ?s - shelf: near(?a, ?s)
    with ?t - thing: near(?s, ?t), ?t != ?a
    then 0.9: size(?s) := big, wet(?t), not near(?a, ?s), forall ?o - box: near(?t, ?o) => load(?o) += 1
         rest: nothing
  }
  rule rinse_it: rinse(?t) {
    when joined(?t, ?t), size(?t) != medium
    then 1: wet(?t), size(?t) := medium, forall ?a ?b - box: near(?a, ?b), load(?a) = 3 => not near(?a, ?b)
  }
  rule ring_it: ring() {
    then 0.5: forall ?b - box: open(?b) => (load(?b) := 0, not open(?b)), total() += 1,
              reward -= 1/3, cost += 2
         0.5: alarm(), total() -= 2
         0:   not alarm()
  }
  default { 0.8: nothing  0.2: noise }
  reward  { 2 * decrease(wets) - 0.5 * heavy + damp - cost - 0.1 * duration + 3 * goal }
}
"""
"""Each construct of the language at least once, but for a `forall` whose shifts add up."""

SOME = """
problem some {
  domain  = everything
  objects { b1 b2 - box  c1 - crate  s1 s2 - shelf }
  init {
    under(b1, s1), under(s1, s2), near(b1, s1), wet(c1), at(b1, home)
    size(b1) = small, size(b2) = big, size(c1) = medium, size(s1) = small, size(s2) = big, size(first) = small
    load(b1) = 2, load(b2) = 0, load(c1) = -1, load(first) = 3, total() = 2
    kind(b1) = paper, kind(b2) = paper, kind(c1) = glass, kind(first) = paper
    toll() = 2
    far(b1, b1) = 0, far(b1, b2) = 1, far(b1, c1) = 2, far(b1, first) = 3
    far(b2, b1) = 4, far(b2, b2) = 0, far(b2, c1) = 1, far(b2, first) = 2
    far(c1, b1) = 3, far(c1, b2) = 4, far(c1, c1) = 0, far(c1, first) = 1
    far(first, b1) = 2, far(first, b2) = 3, far(first, c1) = 4, far(first, first) = 0
  }
  goal    { forall ?b - box: not wet(?b), total() = 5 }
  horizon = 4
}
"""

LAMPS = """
domain lamps {
  types      { lamp }
  predicates { on(?l - lamp)  beside(?a ?b - lamp) [symmetric, static] }
  functions  { heat(?l - lamp): 0..2 }
  derived    { dark := count ?l - lamp: not on(?l) }
  actions    { press(?l - lamp) [cost = 0.5] }
  rule press_cold: press(?l) {
    when heat(?l) < 2, not on(?l)
    then 0.75: on(?l), heat(?l) += 1
         rest: noise
  }
  rule press_hot: press(?l) {
    when heat(?l) = 2
    then 1: not on(?l), heat(?l) := 0, forall ?o - lamp: beside(?l, ?o) => not on(?o)
  }
  reward { decrease(dark) - cost }
}
"""

DRIVEN = """
domain driven {
  types      { place }
  constants  { home - place }
  predicates { at(?p - place)  tired(?p - place) }
  functions  { far(?p ?q - place): 0..9 [static]  toll(): 1..3 [static]  steep(?p - place): 0..1 [static] }
  actions    {
    drive(?p ?q - place) [cost = 1.5 + 1/3 * far(?p, ?q) + 2 * far(?q, home) + toll()]
    climb(?p - place)    [cost = steep(?p)]
    sleep()              [cost = 0.25]
  }
  rule drive_there: drive(?p, ?q) { when at(?p), ?p != ?q  then 0.9: at(?q), not at(?p)  rest: nothing }
  rule climb_it: climb(?p) { when at(?p), steep(?p) = 1  then 1: tired(?p) }
  rule sleep_well: sleep() { then 0.5: not tired(home)  rest: nothing }
  reward { 5 * goal - cost }
}
"""
"""Costs that depend on objects."""

TOUR = """
problem tour {
  domain  = driven
  objects { a b - place }
  init {
    at(a), toll() = 2, steep(a) = 0, steep(b) = 1, steep(home) = 0
    far(a, a) = 0, far(a, b) = 1, far(a, home) = 2
    far(b, a) = 3, far(b, b) = 0, far(b, home) = 1
    far(home, a) = 2, far(home, b) = 3, far(home, home) = 0
  }
  goal { at(b), tired(b) }
"""
"""Without its end: a horizon follows."""

FISHING = """
domain fishing {
  types      { pond; boat }
  constants  { sea - pond }
  predicates { stocked(?p - pond)  at(?b - boat ?p - pond)  torn() }
  functions {
    size(?p - pond): 0..9 [static]
    wear(?b - boat ?p - pond): 0..4 [static]
    tax(): 1..3 [static]
  }
  derived    { stocks := count ?p - pond: stocked(?p) }
  actions {
    cast(?p - pond)              [cost = 1 + 1/2 * size(?p)]
    sail(?b - boat ?p ?q - pond) [cost = wear(?b, ?q)]
    mend()
  }
  rule cast_it: cast(?p) {
    when stocked(?p), not torn()
    with ?b - boat: at(?b, ?p)
    then 0.5: not stocked(?p), reward += 2 + 0.5 * size(?p) + 1/3 * size(sea), reward -= wear(?b, ?p)
         0.2: torn(), reward -= 1/4 + 2 * tax(), cost += wear(?b, ?p) + 3 * wear(?b, sea)
         0.1: reward += size(?p), cost += tax()
         rest: nothing
  }
  rule sail_there: sail(?b, ?here, ?there) {
    when at(?b, ?here), ?here != ?there
    then 0.75: at(?b, ?there), not at(?b, ?here), cost += 1/2 * size(?there)
         0.25: if torn() => stocked(?there), reward -= wear(?b, ?there)
  }
  rule mend_it: mend() {
    when torn()
    then 1: not torn(), cost += 3
  }
  reward { decrease(stocks) - 2 * cost }
}
"""
"""Prices of all kinds: of either sign, of constants, of what is referred to, of numbers, and of counts."""

POND = """
problem pond {
  domain  = fishing
  objects { lake moor - pond  punt raft - boat }
  init {
    stocked(lake), stocked(sea), at(punt, lake), at(raft, moor), tax() = 3
    size(lake) = 4, size(moor) = 1, size(sea) = 9
    wear(punt, lake) = 1, wear(punt, moor) = 2, wear(punt, sea) = 4
    wear(raft, lake) = 0, wear(raft, moor) = 3, wear(raft, sea) = 2
  }
  horizon = 5
}
"""

TOLL = """
domain toll {
  predicates { there() }
  actions    { go() [cost = 0.5] }
  rule go_there: go() { then 0.5: there(), reward += 2  0.25: cost += 1.5  rest: nothing }
  reward     { goal - 2 * cost }
}
"""
"""Outcomes that pay."""
