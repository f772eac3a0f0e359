"""What a plan promises, what planners earn in simulations, and what executions and studies come to: one
probability, for a file in which the likeliest outcome of each action is that nothing happens."""

from __future__ import annotations

from math import sqrt
from pathlib import Path
from typing import Any

import pytest

from cleancli.api.executions import execute_series
from cleancli.api.plans import plan
from cleancli.api.simulations import simulate
from support.studies import opened, rows_here

PRINTROOM = """
domain printroom {
  types      { job printer }
  predicates { printed(?j - job)  jammed(?p - printer)  broken(?p - printer) }
  actions    { print(?j - job, ?p - printer)  clear(?p - printer) }

  rule print_it: print(?j, ?p) {
    when not printed(?j), not jammed(?p), not broken(?p)
    then 0.3: printed(?j)
         0.1: jammed(?p)
         rest: nothing
  }
  rule clear_it: clear(?p) {
    when jammed(?p), not broken(?p)
    then 0.15: not jammed(?p)
         0.05: broken(?p)
         rest: nothing
  }
  reward { goal }
}
"""
JOBS = """
problem jobs {
  domain  = printroom
  objects { j1 j2 - job  p1 - printer }
  init    { jammed(p1) }
  goal    { forall ?j - job: printed(?j) }
  horizon = unlimited
}
"""
EPISODES = 200


def promised() -> float:
    """One of four printers that are jammed breaks while it is cleared. Of prints that do not leave all as it
    is, one of four jams the printer: from a free printer a job is printed with r = 3/4 + 1/4 · 3/4 · r."""
    cleared = 0.15 / 0.2
    printed = 0.75 / (1 - 0.25 * cleared)
    return cleared * printed**2


def files(folder: Path) -> tuple[str, str]:
    (folder / "printroom.nid").write_text(PRINTROOM, encoding="utf-8")
    (folder / "jobs.nid").write_text(JOBS, encoding="utf-8")
    return str(folder / "printroom.nid"), str(folder / "jobs.nid")


def within_sampling_error(successes: int) -> bool:
    """Within three standard deviations of the frequency of as many draws."""
    p = promised()
    return abs(successes / EPISODES - p) <= 3 * sqrt(p * (1 - p) / EPISODES)


def test_plan_simulate_execute_and_a_study_agree(tmp_path: Path) -> None:
    """Executions and studies carry out one course, seed by seed, so that a few of the former are enough."""
    domain, problem = files(tmp_path)
    told: Any = plan(domain, problem, planner="exact").to_dict()
    assert told["reached"]["probability"] == pytest.approx(promised())
    simulated = simulate(domain, problem, planner="exact", episodes=EPISODES)
    assert within_sampling_error(sum(bool(each.success) for each in simulated.episodes[0]))
    study = f'study s {{ domain = "{domain}" scene = "{problem}" planner = exact runs = {EPISODES} }}'
    rows = rows_here(opened(study))
    assert {row.axes["strategy"] for row in rows} == {"plan-1"}
    assert within_sampling_error(sum(row.clean for row in rows))
    done = execute_series(domain, problem, episodes=12, planner="exact", runs=tmp_path / "runs")
    assert [run.clean for run in done.runs] == [row.clean for row in rows[:12]]
