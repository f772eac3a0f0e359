"""A teacher, who is asked where no plan is believed to reach the goal (Martínez et al. 2014, REX-D)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from cleancli.execution.episode_state import Move
from cleancli.language.diagnostics.plural import plural
from cleancli.language.diagnostics.refused import Refused
from cleancli.language.model import Domain, Problem
from cleancli.learning.exploration.explored import Explored
from cleancli.planning.plan import Options, PlanningRefused
from cleancli.planning.registry import DEFAULT, PLANNERS
from cleancli.simulation.agent import Agent

ASK = "ask"
"""In place of a teacher's file: a person at the terminal."""


@dataclass(frozen=True, slots=True)
class Question:
    """What a teacher is asked: the problem as it stands, and of each action how often it was tried and how
    often that changed anything, least known first. `seed` is that of the decision."""

    domain: Domain
    problem: Problem
    experience: tuple[tuple[str, int, int], ...]
    seed: int

    def __str__(self) -> str:
        known = [_told(*each) for each in self.experience]
        return f"no plan is believed to reach the goal; known least: {', '.join(known)}"


Teacher = Callable[[Question], Move | None]
"""What to do now; None where the teacher knows no better either."""


def question(found: Explored, domain: Domain, problem: Problem, seed: int) -> Question:
    """What to ask, of the actions of a domain."""
    counts = []
    for action in domain.actions:
        known = found.actions.get(action.name)
        done = () if known is None else known.transitions
        counts.append((action.name, len(done), sum(bool(each.changed) for each in done)))
    return Question(domain, problem, tuple(sorted(counts, key=lambda each: each[:0:-1])), seed)


def _told(action: str, tried: int, changed: int) -> str:
    if not tried:
        return f"{action} (never tried)"
    return f"{action} ({plural(tried, 'try', 'tries')}, {changed} changed something)"


def of_rules(rules: Domain, samples: int) -> Teacher:
    """The teacher who does what the default planner would do first by these rules."""

    def teacher(asked: Question) -> Move | None:
        agent = Agent(PLANNERS[DEFAULT], rules, asked.problem)
        try:
            plan, _ = agent.plan(asked.problem.state, Options(samples, asked.seed))
        except (Refused, PlanningRefused):
            return None
        return Move(plan.actions[0].name, plan.actions[0].objects) if plan.actions else None

    return teacher
