"""What a person sees while an episode runs, in terminals of all sizes and in none."""

from __future__ import annotations

import io
import json
import sys
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest
from rich.console import Console

from cleancli.cli import progress
from cleancli.cli.main import run
from cleancli.cli.views import dashboard as views
from cleancli.cli.views.dashboard import Shown, came_of, dashboard, updated
from cleancli.cli.views.live import show
from cleancli.cli.views.table_map import rows_for, table_map
from cleancli.compiler.fluents import values_of
from cleancli.execution.episode_state import Account, EpisodeState, Move, Situation
from cleancli.execution.events import (
    Acted,
    Checkpoint,
    Decided,
    Ended,
    Event,
    Failed,
    Looked,
    Moved,
    Purpose,
    Started,
    StrokeEnded,
)
from cleancli.geometry.ellipse import Ellipse
from cleancli.language.model import Fact
from cleancli.learning.experience import Transition
from cleancli.motion.actions import tool_path
from cleancli.perception.area import Area
from support import small_tasks
from support.golden import check_golden
from support.planned import planned
from support.shipped import shipped_scene

ROOT = Path(__file__).parents[2]
SCENE = shipped_scene("two_groups")


def area(name: str, x: float, y: float, half: float = 0.03) -> Area:
    return Area(Ellipse((x, y), (half, half / 2), 0.0), 1e-4, name)


def situation(*areas: Area, unseen: tuple[str, ...] = ()) -> Situation:
    return Situation(areas, (), frozenset(), frozenset(unseen))


A1, A2 = area("a1", -0.2, 0.12), area("a2", 0.1, -0.2)
MOVES = (Move("moveToContainerFast", ("a1",)), Move("moveToContainerStraight", ("a2",)))
PATH = tool_path("moveToContainerFast", (A1.ellipse,), SCENE)
SPENT = Account(planning=1.5, perceiving=0.4, transits=3.0, actions=7.1)
EVENTS: tuple[Event, ...] = (
    Looked(situation(A1, A2), None, 0.2, Purpose.FIRST),
    Decided(situation(A1, A2), MOVES, None, 1.5),
    Started(1, MOVES[0], PATH),
    Moved(4.2),
    StrokeEnded(1, 9.9),
    Looked(situation(A2, unseen=("a2",)), None, 0.2, Purpose.AFTER),
    Acted(1, MOVES[0], None, True, 3.0, 7.1, situation(A2, unseen=("a2",))),
    Checkpoint(EpisodeState(spent=SPENT)),
    Started(2, MOVES[1], tool_path("moveToContainerStraight", (A2.ellipse,), SCENE)),
    Moved(12.0),
    Failed(
        2,
        MOVES[1],
        "it can't reach (10.0 cm, -20.0 cm): [too far] and a reason that is long beyond all measure",
    ),
    Ended("nothing is left to do", True, 2, SPENT, 12.0, 0.0),
)
SIZES = [(80, 24), (120, 50), (60, 24), (46, 16), (30, 20), (24, 14), (20, 5), (8, 2)]


def shown(*events: Event) -> Shown:
    state = Shown()
    for event in events:
        state = updated(state, event)
    return state


def drawn(state: Shown, size: tuple[int, int], ascii_only: bool = False) -> list[str]:
    console = Console(file=io.StringIO(), width=size[0], height=size[1], force_terminal=True, record=True)
    console.print(dashboard(state, SCENE, 60, size, ascii_only))
    return console.export_text().rstrip("\n").split("\n")


@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("events", range(len(EVENTS) + 1))
def test_nothing_is_wider_than_the_terminal_or_wraps(size: tuple[int, int], events: int) -> None:
    state = shown(*EVENTS[:events])
    lines = drawn(state, size)
    assert max(len(line) for line in lines) <= size[0]
    rows = rows_for(SCENE, size[0]) + 2
    assert len(lines) <= max(rows, 20)
    one_line = size[0] < 24 or size[1] < 14
    assert (len(lines) == 1) == one_line


@pytest.mark.parametrize("told", [None, lambda situation: f"{len(situation.areas)} left"])
def test_it_says_what_is_being_done(told: Callable[[Situation], str] | None) -> None:
    """On a table the arm leaves the view before it acts, and a look follows; the symbolic world has neither,
    and words of its own for what is seen."""
    state, doing, words = Shown(), [], []
    for event in EVENTS[:6]:
        state = updated(state, event, told)
        doing.append(state.doing)
        words.append(state.told)
    leaving, after = ("moving the arm out of view", "looking") if told is None else ("acting", "acting")
    assert doing[:2] == ["thinking", leaving]
    assert doing[4:] == [after, "thinking"]
    assert (words[0], words[-1]) == (("", "") if told is None else ("2 left", "1 left"))


def test_it_shows_the_table_the_plan_and_what_happened() -> None:
    before = drawn(shown(*EVENTS[:4]), (80, 24))
    text = "\n".join(before)
    for words in (
        "1. moveToContainerFast(a1)",
        "still planned",
        "moveToContainerStraight(a2)",
        "4.2 s",
        "of 2",
    ):
        assert words in text
    top, bottom = (next(n for n, line in enumerate(before) if name in line[:38]) for name in ("a1", "a2"))
    assert top < bottom, "north is up"
    assert "····" in before[top], "the way to the container"
    assert "┃" in before[top], "whose mouth is in the east"
    after = "\n".join(drawn(shown(*EVENTS[:9]), (80, 24)))
    assert "a1 gone" in after
    assert "still planned" not in after
    assert "  actions              7.1 █████░░░" in after, "7.1 of 12 seconds"
    assert "dirty areas 1 ████░░░░ of 2" in after
    assert "failed" in "\n".join(drawn(shown(*EVENTS[:11]), (80, 24)))


def test_the_dashboard_is_drawn_as_it_was(monkeypatch: pytest.MonkeyPatch) -> None:
    """tests/golden/transcripts/dashboard.txt, which CLEANCLI_REGENERATE=1 writes anew."""
    monkeypatch.setattr(views, "SPINNER", "||||")  # that tells the time
    shots = [(events, size, False) for events in (0, 2, 4, 9, 11, 12) for size in ((80, 24), (120, 50))]
    shots += [(9, (60, 24), False), (9, (46, 16), True), (11, (30, 20), False), (12, (20, 5), False)]
    frames = [
        f"{events} events, {size[0]} x {size[1]}\n"
        + "\n".join(line.rstrip() for line in drawn(shown(*EVENTS[:events]), size, ascii_only))
        for events, size, ascii_only in shots
    ]
    check_golden("transcripts/dashboard.txt", "\n\n".join(frames) + "\n")


def test_hidden_areas_the_tool_and_places_beside_the_surface() -> None:
    path = PATH
    text = table_map(SCENE, situation(area("a1", 0.2, 0.2, 0.08), unseen=("a1",)), path, (0.0, 0.0), 36).plain
    assert "░" in text
    assert "▒" not in text
    assert text.count("█") == 1
    assert "█" not in table_map(SCENE, None, None, (0.9, 0.0), 36).plain
    lines = table_map(SCENE, situation(area("a123", 0.449, 0.349)), None, None, 20).plain.split("\n")
    assert len({len(line) for line in lines}) == 1
    assert "a123" in lines[1], "a name at the edge stays whole"


def test_a_terminal_that_knows_ascii_alone_gets_no_other_characters() -> None:
    for events in range(len(EVENTS) + 1):
        for size in SIZES:
            assert "\n".join(drawn(shown(*EVENTS[:events]), size, ascii_only=True)).isascii()


def test_what_came_of_an_action() -> None:
    acted = Acted(3, MOVES[0], None, True, 1.0, 1.0, situation(A2, area("a10", 0, 0), area("a9", 0, 0.1)))
    assert came_of(frozenset({"a1", "a2"}), acted) == "3. moveToContainerFast(a1): a1 gone, a9, a10 new"
    many = frozenset(f"a{number}" for number in range(20, 30))
    assert "a20, a21, a22 and 7 more gone" in came_of(many | {"a2", "a9", "a10"}, acted)
    assert came_of(frozenset({"a2", "a9", "a10"}), acted).endswith("no area came or went")
    kept, gone, new = Fact("door", ("d",)), Fact("open", ("d",)), Fact("shut", ("d",))
    pushed = Transition(
        "push", ("d",), (), values_of(frozenset({kept, gone})), values_of(frozenset({kept, new}))
    )
    nowhere = Situation((), (), frozenset({kept, new}))
    told = came_of(frozenset(), replace(acted, transition=pushed, situation=nowhere))
    assert told == "3. moveToContainerFast(a1): not open(d), shut(d)"
    poured = pushed._replace(before={("pot", ()): 4}, after={("pot", ()): 3})
    assert came_of(frozenset(), replace(acted, transition=poured, situation=nowhere)).endswith(": pot() = 3")
    vain = pushed._replace(after=pushed.before)
    assert came_of(frozenset(), replace(acted, transition=vain, situation=nowhere)).endswith(
        ": nothing changed"
    )


def told(terminal: bool) -> str:
    stream = io.StringIO()
    console = Console(file=stream, width=80, height=24, force_terminal=terminal, highlight=False)
    with show(False, SCENE, lambda: (0.1, 0.1), 60, console) as view:
        for event in EVENTS:
            view.write(event)
    return stream.getvalue()


def test_no_terminal_gets_plain_lines() -> None:
    text = told(terminal=False)
    assert "\x1b" not in text
    assert text.splitlines()[0] == "looked: a1, a2 (0.20 s)"
    assert "  1. moveToContainerFast(a1): a1 gone" in text
    assert "[too far]" in text, "what stands in brackets is no markup"
    assert text.splitlines()[-1] == "ended: nothing is left to do"


def test_what_is_hidden_stands_in_parentheses() -> None:
    """As docs/execution.md shows it."""
    stream = io.StringIO()
    with show(False, console=Console(file=stream, width=80, highlight=False)) as view:
        view.write(Looked(situation(A1, A2, unseen=("a2",)), None, 0.2, Purpose.AFTER))
    shown = stream.getvalue().partition(" (0.20 s)")[0]
    assert shown == "looked: a1, (a2)"
    assert f"`{shown}`" in (ROOT / "docs" / "execution.md").read_text(encoding="utf-8")


def test_a_decision_that_takes_long_is_told_outside_a_terminal(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """A planner may have to be compiled first (docs/commands.md: two seconds, unless they are set)."""
    monkeypatch.setenv("CLEANCLI_PROGRESS_AFTER", "0.05")
    looked = Looked(situation(A1, A2), None, 0.2, Purpose.FIRST)
    for plain, word in ((False, "deciding ...\n"), (True, "")):
        with show(False, console=Console(file=io.StringIO(), width=80), plain=plain) as view:
            view.write(looked)
            time.sleep(0.3)
            view.write(Ended("nothing is left to do", True, 2, SPENT, 12.0, 0.0))
            time.sleep(0.1)
        assert capsys.readouterr() == ("", word)


def test_a_terminal_gets_the_lines_and_the_table_which_goes_at_the_end() -> None:
    text = told(terminal=True)
    assert "looked: a1, a2 (0.20 s)" in text
    assert "┌" in text
    assert text.rindex("\x1b[?25h") > text.rindex("┌"), "the cursor is back"
    assert text.endswith("\x1b[2K"), "and the table is wiped away"


@pytest.mark.parametrize("option", ["--json", "--quiet"])
def test_programs_are_not_talked_to(option: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    words = ["execute", "cleaning", "three_areas", "--samples", "100", "--runs", str(tmp_path), option]
    assert run(words) == 0
    out, err = capsys.readouterr()
    assert err == ""
    assert (json.loads(out)["seed"] == 1) if option == "--json" else (out == "")
    assert (next(tmp_path.iterdir()) / "run.json").exists()


def test_the_time_of_a_domain_is_shown_where_there_is_some() -> None:
    size = (80, 24)
    said = "burning 1; the goal does not hold"
    before, after = (drawn(replace(Shown(), told=said, clock=clock), size) for clock in (0.0, 2.0))
    assert not any("time of the domain" in line for line in before)
    assert any("time of the domain 2.0 s" in line for line in after)
    assert any("robot time 0.0 s" in line for line in drawn(Shown(), size))


class _Stream(io.StringIO):
    """What standard error may be."""

    def __init__(self, terminal: bool) -> None:
        super().__init__()
        self._terminal = terminal

    def isatty(self) -> bool:
        return self._terminal


@pytest.mark.parametrize(
    ("terminal", "quiet", "shown"), [(True, {}, True), (True, {"quiet": True}, False), (False, {}, False)]
)
def test_what_takes_its_time_is_told_in_a_terminal_unless_it_is_to_be_quiet(
    terminal: bool, quiet: dict[str, bool], shown: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    out = _Stream(terminal)
    monkeypatch.setattr(sys, "stderr", out)
    with progress.working("thinking hard", **quiet):
        pass
    assert ("thinking hard" in out.getvalue()) == shown


@pytest.mark.parametrize("compiled", [True, False])
@pytest.mark.parametrize("seconds", [0.1, 40.0])
def test_the_time_to_compile_is_told_where_it_is_long_and_is_not_called_loading(
    compiled: bool, seconds: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("cleancli.cli.kernels.has_compiled", lambda: compiled)
    plan = replace(planned("prada", small_tasks.random_task(0), samples=5), seconds={"compile": seconds})
    out = io.StringIO()
    with show(False, SCENE, console=Console(file=out, width=100)) as view:
        view.write(Decided(situation(A1), MOVES, plan, 1.5))
    what = "compiling the planner, once after installation" if compiled else "loading the planner"
    assert ("the planner" in out.getvalue()) == (seconds > 1)
    assert (f"(and 40 s for {what})" in out.getvalue()) == (seconds > 1)


@pytest.mark.parametrize(
    ("problem", "looks"),
    [("three_areas", False), pytest.param("two_groups", True, marks=pytest.mark.needs_pybullet)],
)
def test_a_terminal_says_that_the_table_is_looked_at_where_there_is_one(
    problem: str, looks: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    out = _Stream(True)
    monkeypatch.setattr(sys, "stderr", out)
    assert run(["compile", "cleaning", problem]) == 0
    assert ("looking at the table" in out.getvalue()) == looks


def test_who_ran_out_of_seconds_is_told_what_raises_the_limit(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = ["execute", "cleaning", "three_areas", "--samples", "50", "--runs", str(tmp_path)]
    assert run([*words, "--max-seconds", "5"]) == 3
    told = capsys.readouterr()
    assert "the limit of 5 seconds is reached" in told.out
    assert "note: --max-seconds raises the limit of seconds" in told.err
    assert run([*words, "--max-actions", "1"]) == 3
    assert "--max-seconds" not in capsys.readouterr().err
