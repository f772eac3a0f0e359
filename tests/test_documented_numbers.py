"""Numbers that the documents state are those of the code: whoever changes one changes the other.

A row is a constant (or an expression of one), a page, and the words around the number there, with the number
in braces.
"""

from __future__ import annotations

import importlib
import math
import re
from functools import cache
from pathlib import Path
from typing import Any

import pytest

from cleancli.planning.plan import Options
from cleancli.planning.registry import PLANNERS

ROOT = Path(__file__).parent.parent
NUMBERS = """
compiler.grounding_size.RULE_BYTES / 1024 | planners.md | at {:.0f} KiB each
compiler.grounding_size.PART_BYTES | planners.md | literals and effects at {} bytes
compiler.disjoint_cases.CASE_LIMIT | planners.md | into more than {:,} cases
compiler.exclusive_pairs.MOST_VALUES | planners.md | more than {:,} values of all state variables
compiler.exclusive_pairs.MOST_WAYS | planners.md | {:,} ways in which outcomes leave them
compiler.exclusive_pairs.MOST_LOOKS | planners.md | {:,} ways and pairs of ways
compiler.exclusive_pairs.MOST_DROPPED | planners.md | {:,} cases that are left out before they are whole
compiler.partial_evaluation.STEP_LIMIT | planners.md | too many paths ({:,} steps)
compiler.semantics.SUPPORT_LIMIT | planners.md | follows the whole distribution, up to {:,} states
planning.evaluation.value.RUNS | planning.md | the mean of {:,} drawn runs
planning.evaluation.forecast.FEW_STATES | planning.md | exact up to {:,} states
planning.evaluation.forecast.RUNS | planning.md | from more, {:,} runs are drawn
planning.kernels.belief_search.PORTION | planners.md | every {:,} samples of each thread
planning.planners.prada_plus.FRESH_WORDS * 64 | planners.md | valued again by {:,} fresh runs
cli.views.plan_picture.MOST_ROWS | planning.md | those that change most if there are over {}
execution.table_cell.FURTHER * 1000 | execution.md | the rag is pressed {:.0f} mm further each time
world.robot.LONGEST | execution.md | counts as failed after {:.0f} seconds
world.robot.STILL | execution.md | the clock stands still for {:.0f} seconds
remote.wire.LARGEST_HEAD | protocol.md | 2 to {:,}
remote.wire.LARGEST_BODY | protocol.md | {:,}
remote.server.LARGEST_REQUEST | protocol.md | {:,}
remote.messages.APART * 1000 | protocol.md | at most {:.0f} ms apart
remote.client.ANSWERING | protocol.md | It waits {:.0f} s for
remote.client.PATIENCE | protocol.md | and {:.0f} s for the rest
remote.robot.ENDED * 100 | protocol.md | more than {:.0f} cm away
remote.messages.MOST_WAYPOINTS | protocol.md | n from 1 to {:,}
recording.begun.ROOM / 2**20 | runs.md | than a long one takes ({:.0f} MB
environment.MOST_ACTIONS | gym.md | actions until truncation ({})
language.parsing.read.LARGEST / 2**20 | diagnostics.md | is larger than {:.0f} MiB
language.checking.symbols.MOST_VALUES | diagnostics.md | at most {} values
language.checking.problem._LONGEST | language.md | a number up to {}
language.printing.formatter_blocks.WIDTH | commands.md | if it fits {} columns
world.constants.TABLE_HEIGHT | world.md | A table {:.2f} m above
world.constants.CONTAINER_OVERLAP * 100 | world.md | a container that reaches {:.0f} cm under it
world.constants.INK_CELL * 1000 | world.md | cells of {:.0f} mm on the surface
world.constants.FLAP_LEAN | world.md | lean back by {} rad
world.constants.HEIGHT_NOISE * 1000 | world.md | {} mm in height
world.constants.PRESS * 1000 | world.md | aims {:.0f} mm below the surface
world.constants.SIDE_NOISE * 1000 | world.md | {:.0f} mm sideways
world.constants.YAW_NOISE | world.md | {} rad in yaw
world.robots.constants.WAM_GAP * 100 | world.md | or {:.0f} cm from the edge of a deeper table
world.robots.constants.REEM_SHOULDERS * 200 | world.md | Two arms on shoulders {:.0f} cm apart
world.robots.constants.REEM_ABOVE * 100 | world.md | and {:.0f} cm above the surface
world.robots.constants.PAN_LIP * 1000 | world.md | (lip {} mm,
world.robots.constants.PAN_HELD | world.md | the lip is raised by {:.2f} rad
world.robots.constants.PAN_LEAN | world.md | with its lip raised by {} rad
world.robots.constants.PAN_LEANS[0] | world.md | (within {} to
world.robots.constants.PAN_LEANS[1] | world.md | to {:.2f} rad, OMPL
world.robots.constants.PAN_GAP * 1000 | world.md | {} mm above the surface while the dustpan stands
motion.wiping.PASSES | world.md | goes {} times over each place
motion.wiping.MARGIN * 100 | world.md | the rag's width less {:.0f} cm at either end
motion.wiping.BEYOND * 100 | world.md | from {:.0f} cm beyond it
motion.wiping.DRIFT * 1000 | world.md | Each pass drifts {:.0f} mm aside
motion.pace.TRANSIT_SPEED | world.md | travels between strokes at {} m/s
motion.pace.FAST_SPEED | world.md | differ in speed ({:.2f} and
motion.pace.STRAIGHT_SPEED | world.md | (0.20 and {} m/s
motion.pick_up.PAN_SLOPE | world.md | slope {})
motion.pick_up.ONTO_PAN * 100 | world.md | and {:.0f} cm onto the dustpan
motion.pick_up.TIP * -1 | world.md | tipped by {:.0f} rad
motion.pace.LIFT * 100 | world.md | begins and ends {:.0f} cm above the surface
motion.pace.VERTICAL_SPEED | world.md | comes down and is lifted at {:.2f} m/s
motion.corners.CLEARANCE * 100 | world.md | The tool comes down {:.0f} cm behind
motion.actions.OVERSHOOT * 100 | world.md | the whole rag is {:.0f} cm past the edge
motion.way_out.GREATEST_SLANT | world.md | slants by more than {:.0f}°
perception.symbols.GREATEST_TURN | perception.md | the stroke turns by at most {:.0f}° at b
motion.way_out.WORTH * 100 | world.md | less {:.0f} cm for each other dirty area
motion.corners.TURN_STRETCH * 100 | world.md | stroke is turned from {:.0f} cm before
motion.joint_path.RAISE * 100 | world.md | over a middle raised by {:.0f} cm
motion.joint_path.AIR * 100 | world.md | and the rag {} cm above it
motion.clearance.TABLE_GAP * 100 | world.md | the links {:.0f} cm clear
motion.clearance.SELF_GAP * 100 | world.md | the links {:.0f} cm clear
motion.legs.SPACING * 1000 | world.md | at poses {:.0f} mm apart
perception.surface.TRIPLES | perception.md | {} triples
perception.surface.JUDGES | perception.md | judged by {} points
perception.surface.HOLE - 1 | perception.md | unknown depth up to {} pixels wide
perception.surface.MISPLACED * 100 | perception.md | a plane more than {:.0f} cm off
perception.surface.MOST_TILT | perception.md | at more than {:.0f} degrees
perception.outline.FITS * 100 | perception.md | up to {:.0f} %
perception.outline.FILLS * 100 | perception.md | holds {:.0f} % of the image
perception.calibrate.MARGIN["tolerance"] | perception.md | stores {}, 1.35 and 1.3 times as much
perception.calibrate.MARGIN["gradient"] | perception.md | stores 1.25, {} and 1.3 times as much
perception.calibrate.MARGIN["contrast"] | perception.md | stores 1.25, 1.35 and {} times as much
perception.calibrate.EVEN * 100 | perception.md | regions take in {:.0f} % of what is trusted
perception.fit.BRIGHTER * 100 | perception.md | surface is {:.0f} % brighter or darker
perception.fit.UNEVEN * 100 | perception.md | that changed by {:.0f} % more or less
perception.fit.RECOLOURED | perception.md | differ by more than {})
perception.fit.TURNED | perception.md | angle ({:.0f} degrees
perception.occlusion.CELL * 1000 | perception.md | as cells of {:.0f} mm
"""
ROWS = [tuple(map(str.strip, row.split("|"))) for row in NUMBERS.strip().splitlines()]
OPTIONS = {
    "rule_threshold": "`rule_threshold` ({}; 0 is allowed)",
    "margin": "by more than `margin` ({})",
    "solve": "`solve` ({}) times as many transitions may be enumerated",
    "runs": "each by `runs` ({}) runs",
    "counted": "`counted` objects ({}",
}


@cache
def page(name: str) -> str:
    return " ".join((ROOT / "docs" / name).read_text(encoding="utf-8").split())


def value(expression: str) -> Any:
    """An expression that begins with a constant of a module."""
    match = re.fullmatch(r"([\w.]+)\.(\w+)(.*)", expression)
    assert match is not None
    module = importlib.import_module(f"cleancli.{match[1]}")
    return eval(f"constant{match[3]}", {"constant": getattr(module, match[2])})


@pytest.mark.parametrize(("expression", "name", "words"), ROWS, ids=[row[0] for row in ROWS])
def test_the_document_states_the_number_of_the_code(expression: str, name: str, words: str) -> None:
    number = value(expression)
    told = words.format(number)
    assert told in page(name), f"docs/{name} says otherwise, or in other words"
    figure = re.search(r"\{[^}]*\}", words)
    assert figure is not None
    assert math.isclose(float(figure[0].format(number).replace(",", "")), number, rel_tol=1e-9)


@pytest.mark.parametrize("option", OPTIONS)
def test_options_of_planners_are_as_documented(option: str) -> None:
    records = (Options(), *(planner.own for planner in PLANNERS.values()))
    (usual,) = {getattr(record, option) for record in records if hasattr(record, option)}
    assert OPTIONS[option].format(usual) in page("planning.md") + page("planners.md")
