"""Where a factored belief misjudges plans, and what each planner then does: `python benchmarks/beliefs.py`.

Three examples: that of §4 (two scattered areas); conditions that exclude each other, which libPRADA takes as
independent; and one cause with several effects (domains/courier.nid). A value is the expected reward within
two steps, by libPRADA's belief, by ours, and exactly. Nothing is drawn but PRADA's samples, whose seed may be
given. About ten seconds of CPU.
"""

from __future__ import annotations

import argparse
import sys
from dataclasses import dataclass
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))
from cleancli.compiler.ground import ground
from cleancli.compiler.semantics import exact_value
from cleancli.compiler.task import Task
from cleancli.language.diagnostics.diagnostic import Source
from cleancli.language.load import load_domain, load_problem
from cleancli.planning.compiled_task import prepare
from cleancli.planning.evaluation.belief_value import plan_value
from cleancli.planning.plan import Options
from cleancli.planning.registry import PLANNERS
from support.small_tasks import SECTION_4, TWO_SCATTERED

FOLDER = Path(__file__).parent / "domains"

EXCLUSIVE = """
domain exclusive {
  types      { area }
  predicates { dirt(?a - area) loose(?a - area) }
  derived    { dirty := count ?a - area: dirt(?a) }
  actions    { loosen(?a - area) wipe(?a - area) scrub(?a - area) }
  rule loosen: loosen(?a) { when dirt(?a), not loose(?a) then 0.8: loose(?a) rest: nothing }
  rule wipe_loose: wipe(?a) { when dirt(?a), loose(?a) then 0.9: not dirt(?a) rest: nothing }
  rule wipe_stuck: wipe(?a) { when dirt(?a), not loose(?a) then 0.3: not dirt(?a) rest: nothing }
  rule scrub: scrub(?a) { when dirt(?a), not loose(?a) then 0.5: not dirt(?a) rest: nothing }
  reward { decrease(dirty) }
}
"""


@dataclass(frozen=True, slots=True)
class Example:
    """A problem, and the plans that are valued."""

    name: str
    domain: str
    problem: str
    plans: tuple[tuple[str, ...], ...]


EXAMPLES = (
    Example(
        "§4: join two scattered areas",
        SECTION_4,
        TWO_SCATTERED,
        (("join(a, b)", "clean(b)"), ("clean(a)", "clean(b)")),
    ),
    Example(
        "conditions that exclude each other",
        EXCLUSIVE,
        "objects { a - area } init { dirt(a) }",
        (("loosen(a)", "wipe(a)"), ("scrub(a)", "scrub(a)")),
    ),
    Example(
        "one cause with several effects",
        (FOLDER / "courier.nid").read_text(encoding="utf-8"),
        "objects { } init { wet(north), wet(east), wet(south) } goal { delivered() }",
        (("wait()", "cross()"), ("detour()",)),
    ),
)


def task_of(example: Example) -> Task:
    domain = load_domain(Source("example.nid", example.domain))
    inside = f"domain = {domain.name} {example.problem} horizon = 2 discount = 1"
    text = f"problem example {{ {inside} }}"
    return ground(domain, load_problem(Source("example problem", text), domain))


def main() -> None:
    """Print the examples."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--seed", type=int, default=1)
    seed = parser.parse_args().seed
    for example in EXAMPLES:
        task = task_of(example)
        names = [str(action) for action in task.actions]
        print(example.name)
        print("  plan                       libPRADA  belief  exact")
        for sequence in example.plans:
            actions = [names.index(action) for action in sequence]
            library, ours = (plan_value(task, actions, compat=compat) for compat in (True, False))
            exact = exact_value(task, actions)
            print(f"  {', '.join(sequence):25}  {library:8.3f}  {ours:6.3f}  {exact:5.3f}")
        # Sequences are compared here, so nothing is solved beyond them.
        for label, planner, compat in (
            ("libPRADA's way", PLANNERS["prada"], True),
            ("prada", PLANNERS["prada"], False),
            ("prada+", PLANNERS["prada+"].having(solve=0), False),
        ):
            plan = planner(prepare(task), Options(1_000, seed, compat=compat))
            chosen = ", ".join(str(action) for action in plan.actions) or "nothing"
            print(f"  {label} chooses {chosen}")
        print()


if __name__ == "__main__":
    main()
