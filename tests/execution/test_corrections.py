"""By how much longer actions take than a table expects, and that plans go by it (docs/learning.md)."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator
from pathlib import Path

import pytest

from cleancli.api.lessons import learn
from cleancli.compiler.task import GroundAction
from cleancli.execution.believed import belief, expected_seconds
from cleancli.execution.episode_state import EpisodeState, Move
from cleancli.execution.events import Acted
from cleancli.execution.events import Learned as LearnedEvent
from cleancli.execution.kinematic_cell import KinematicCell
from cleancli.execution.loop import clean
from cleancli.execution.seeds import Stream, derived
from cleancli.execution.setup import EpisodeOptions, EpisodeSetup, Job, within_reach
from cleancli.execution.workcell import Motion, Motions
from cleancli.learning.durations import learn_corrections
from cleancli.learning.evidence import Evidence, collected
from cleancli.learning.experience import Transition, encode, milliseconds, read_experience
from cleancli.learning.match import Fit, Match, Matcher
from cleancli.learning.method import Method
from cleancli.recording import checkpoint
from cleancli.recording.fitting import check_fits
from cleancli.recording.folder import EXPERIENCE
from cleancli.recording.journal import Learned
from cleancli.recording.journal_writer import Entries
from cleancli.world.kinematic import KinematicTable
from cleancli.world.robot import Status
from support.shipped import shipped_domain, shipped_scene

SCENE, DOMAIN = shipped_scene("scattered_40"), shipped_domain("cleaning")
PUSH = "moveToContainerFast"
SLOWER = 1.5


class SlowTable(KinematicTable):
    """A robot that takes half as long again as one whose joints are quick enough."""

    def poll(self) -> Status:
        before = self.clock
        status = super().poll()
        self.clock += (SLOWER - 1) * (self.clock - before)
        return status


def setup_of(learning: Method | None = None) -> EpisodeSetup:
    options = EpisodeOptions(strategy="reactive", seed=1, max_actions=2, learning=learning)
    return EpisodeSetup(
        DOMAIN, within_reach(DOMAIN, SCENE.arms, Job.CONTAINER), SCENE, Job.CONTAINER, options
    )


def pushes(seed: int) -> Iterator[tuple[int, int]]:
    """Of a push of each area of a table in turn: the milliseconds that it took, and those expected."""
    cell = KinematicCell(DOMAIN, SCENE, SlowTable(SCENE, derived(seed, Stream.WORLD)))
    finished(cell.withdraw())
    situation = cell.look(None, None, 0, 0).situation
    for number, area in enumerate(situation.areas, start=1):
        move = Move(PUSH, (area.name,))
        (expected,) = cell.seconds(situation, [GroundAction(*move.key, None)]).values()
        motions = finished(cell.carry_out(number, move, cell.path(move, situation)))
        yield milliseconds(motions.transit, motions.seconds), round(1000 * expected)


def finished(motion: Motion) -> Motions:
    """How a motion went, to its end."""

    def noted() -> Iterator[Motions]:
        yield (yield from motion)  # type: ignore[misc]

    *_, motions = noted()
    assert isinstance(motions, Motions)
    return motions


@pytest.fixture(scope="module")
def slowly() -> list[tuple[int, int]]:
    return [pair for seed in range(1, 5) for pair in pushes(seed)]


@pytest.fixture(scope="module")
def transitions() -> list[Transition]:
    """Of the first actions of an episode."""
    cell = KinematicCell(DOMAIN, SCENE, SlowTable(SCENE, derived(1, Stream.WORLD)))
    events = clean(setup_of(), cell)
    return [event.transition for event in events if isinstance(event, Acted) and event.transition is not None]


def test_twelve_executions_tell_how_slow_a_robot_is(slowly: list[tuple[int, int]]) -> None:
    """Within 5 % of what all of them say, from an expectation that knows nothing of it."""
    ratios = [took / expected for took, expected in slowly]
    assert len(ratios) >= 40
    mean = sum(ratios) / len(ratios)
    assert mean > 1.25
    (learned,) = learn_corrections(((PUSH, tuple(slowly[:12])),))
    assert (learned.action, float(learned.seen)) == (PUSH, 12)
    assert learned.factor == pytest.approx(mean, rel=0.05)


def test_the_journal_tells_what_is_new_of_it(transitions: list[Transition]) -> None:
    entries = Entries(DOMAIN, lambda: 0.0)
    evidence = collected(Matcher(DOMAIN), transitions)
    told = []
    for _ in range(2):
        now = belief(setup_of(Method()), evidence)
        assert now.lesson is not None
        (entry,) = entries.of(LearnedEvent(now.lesson, now.domain, now.intervals))
        assert isinstance(entry, Learned)
        told.append(entry.corrections)
    (correction,), none = told
    assert none == ()
    (learned,) = learn_corrections(evidence.estimates)
    assert (correction.action, correction.seen) == (learned.action, len(transitions))
    assert correction.factor == pytest.approx(learned.factor, abs=5e-5)


def test_nothing_known_is_a_factor_of_one() -> None:
    """Eq. 5 with a prior that weighs one execution: (2 * 4 + 1 / 2) / (4 + 1 / 2) after four of twice."""
    (learned,) = learn_corrections((("push", ((2000, 1000),) * 4),))
    assert learned.factor == pytest.approx(8.5 / 4.5)
    assert learned.spread == 0
    assert learn_corrections(()) == ()


def test_what_has_faded_counts_for_less() -> None:
    timed = ((1000, 1000),) * 10 + ((2000, 1000),) * 10
    (faded,), (mean,) = (learn_corrections((("push", timed),), forgetting) for forgetting in (0.3, 0.0))
    assert mean.factor == pytest.approx(1.5, abs=0.02)
    assert 1.8 < faded.factor < 2


def test_plans_expect_what_was_learned() -> None:
    learns, stays = setup_of(Method()), setup_of()
    match = Match(None, (Fit(),) * len(learns.domain.default))
    evidence = Evidence((match,), (0,) * 100, estimates=(("push", ((3000, 2000),) * 100),))
    actions = [GroundAction("push", ("a",), 9.0), GroundAction("pull", ("a",), 9.0)]

    def told(given: Iterable[GroundAction]) -> dict[tuple[str, tuple[str, ...]], float]:
        return {action.key: 4.0 for action in given}

    learning = expected_seconds(belief(learns, evidence), told)(actions)
    assert learning == {("push", ("a",)): pytest.approx(6.0, abs=0.01), ("pull", ("a",)): 4.0}
    assert expected_seconds(belief(stays, evidence), told)(actions) == told(actions)


def test_offline_and_online_are_told_the_same(transitions: list[Transition], tmp_path: Path) -> None:
    """A line says what was expected; lines of older files do not, and teach nothing of it."""
    path = tmp_path / "e.jsonl"
    with path.open("w") as file:
        for each in transitions:
            assert each.lasted is not None
            assert each.expected is not None
            told = {"transit": 0.0, "seconds": each.lasted / 1000, "expected": each.expected / 1000}
            file.write(encode(each, told) + "\n")
    assert list(read_experience(path, DOMAIN)) == transitions
    online = learn_corrections(collected(Matcher(DOMAIN), transitions).estimates)
    offline = learn("cleaning", path).corrections
    assert [(each.action, each.seen) for each in offline] == [
        (each.action, float(each.seen)) for each in online
    ]
    assert offline[0].factor == pytest.approx(online[0].factor, abs=5e-5)
    assert 1.2 < offline[0].factor < SLOWER * 1.2
    old = [json.loads(line) for line in path.read_text().splitlines()]
    path.write_text("".join(json.dumps({k: v for k, v in o.items() if k != "expected"}) + "\n" for o in old))
    assert learn("cleaning", path).corrections == ()


def test_an_episode_goes_on_with_what_it_had_learned(tmp_path: Path) -> None:
    state = EpisodeState(evidence=Evidence(estimates=((PUSH, ((3000, 2000), (2500, 2000))),)))
    for name in ("journal.jsonl", EXPERIENCE):
        (tmp_path / name).touch()
    checkpoint.save(tmp_path, state, {})
    read = checkpoint.read(tmp_path, next((tmp_path / "state").iterdir())).episode
    assert read.evidence == state.evidence
    check_fits(read, DOMAIN, None)


@pytest.mark.parametrize(
    "estimates",
    [(("fly", ((1, 1),)),), ((PUSH, ((-1, 1),)),), ((PUSH, ((1, 0),)),), ((PUSH, ((1, 10**15),)),)],
)
def test_what_no_episode_can_have_expected_is_refused(
    estimates: tuple[tuple[str, tuple[tuple[int, int], ...]], ...],
) -> None:
    with pytest.raises(ValueError, match="durations"):
        check_fits(EpisodeState(evidence=Evidence(estimates=estimates)), DOMAIN, None)
