"""A domain that uses every construct, split over two files, and a problem of it."""

from __future__ import annotations

BASE = """\
domain base {
  types      { box  shelf }
  predicates { dirty(?b - box)  wet(?b - box)  below(?a ?b - box) [static]  at(?b - box ?s - shelf) }
  functions  { load(?b - box): 0..3 }
  parameters { spill = 0.25 }
}
"""
DOMAIN = """\
domain tower {
  include "parts/base.nid"
  derived {
    under(?a ?b - box) := closure below
    buried(?b - box) := exists ?o - box: under(?o, ?b)
    left := count ?b - box: dirty(?b)
    soaked := count ?b - box: wet(?b)
  }
  actions { wipe(?b - box) [duration = 3 s [prior 4 s, seen 2.5], cost = 0.5]  lift(?b - box) }
  rule wipe_free: wipe(?b) {
    when dirty(?b), not buried(?b), forall ?o - box: not wet(?o)
    with ?s - shelf: at(?b, ?s)
    then 0.5: not dirty(?b), not at(?b, ?s)
         spill: wet(?b)
         rest: noise
  }
  rule lift_light: lift(?b) {
    when load(?b) < 3
    then 0.9 [fixed]: load(?b) += 1
         0.1: nothing
  }
  default { 1: nothing }
  reward  { 2 * decrease(left) - 0.5 * soaked + 10 * goal - cost }
  learned {
    estimator = decreasing_m
    m         = 10
    match     = shared
    experience "runs/tower-1" [sha256 = "9f86d081884c7d65", transitions = 3]
  }
}
"""
PROBLEM = """\
problem two_boxes {
  domain  = tower
  objects { b1 b2 - box  s1 s2 - shelf }
  init {
    dirty(b1), dirty(b2), below(b1, b2)
    load(b1) = 0, load(b2) = 3
    at(b1, s1), at(b2, s1), at(b2, s2)
  }
  goal    { not dirty(b1), load(b1) >= 2 }
  planner { name = prada  samples = 300  seed = 5 }
  horizon = 4
}
"""
