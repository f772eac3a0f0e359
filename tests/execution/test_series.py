"""Series of episodes that learn and write: cut short, edited meanwhile, and beside learning offline."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from cleancli.api.executions import execute_series, resume, resume_series
from cleancli.api.learned import LearningResult
from cleancli.api.lessons import learn
from cleancli.api.series import SeriesResult
from cleancli.cli.exit_codes import ExitCode
from cleancli.cli.main import run
from cleancli.execution.events import Acted, Ended, Event
from cleancli.language.diagnostics.diagnostic import Source
from cleancli.language.diagnostics.refused import Refused
from cleancli.language.load import load_domain
from support.doors import PULLED

PROBLEM = "problem p { domain = doors objects { a b - door } init { } }"
NAME = "p-seed4-series-001"
ASKED: dict[str, Any] = {
    "episodes": 3,
    "seed": 4,
    "samples": 20,
    "learn": True,
    "write": True,
    "video": False,
    "known": 5,
}


class Killed(BaseException):
    """Stands for a process that is gone: nobody may catch it."""


@pytest.fixture
def own(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A domain to learn into, in the current folder, and beside it the rules that hold."""
    monkeypatch.chdir(tmp_path)
    Path("own.nid").write_text(PULLED % "0.8", encoding="utf-8")
    Path("true.nid").write_text(PULLED % "0.4", encoding="utf-8")
    Path("p.nid").write_text(PROBLEM, encoding="utf-8")
    return Path("own.nid")


def whole(**asked: Any) -> SeriesResult:
    return execute_series("own.nid", "p.nid", world="true.nid", **{**ASKED, **asked})


@pytest.fixture(scope="module")
def undisturbed(tmp_path_factory: pytest.TempPathFactory) -> tuple[str, SeriesResult]:
    """What the series writes that nobody disturbs, and what it comes to."""
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(tmp_path_factory.mktemp("undisturbed"))
        Path("own.nid").write_text(PULLED % "0.8", encoding="utf-8")
        Path("true.nid").write_text(PULLED % "0.4", encoding="utf-8")
        Path("p.nid").write_text(PROBLEM, encoding="utf-8")
        result = whole()
        return Path("own.nid").read_text(encoding="utf-8"), result


def untimed(result: SeriesResult) -> Any:
    """What a series came to, without the seconds that this machine took."""
    told = result.to_dict()
    episodes: Any = told["episodes"]
    kept = [(each["seed"], each["episode"]["actions"], each["episode"]["clean"]) for each in episodes]
    return kept, told["rules"], told["durations"]


def at(episode: int, kind: type[Event], error: type[BaseException]) -> Callable[[Event], None]:
    """Ends the process at the second event of a kind in an episode, or the only one."""
    seen: list[Event] = []

    def follow(event: Event) -> None:
        seen.append(event)
        of_this = sum(isinstance(each, Ended) for each in seen) == episode - (kind is not Ended)
        in_all = sum(isinstance(each, kind) for each in seen[1:])
        if isinstance(event, kind) and of_this and in_all > 1:
            raise error

    return follow


@pytest.mark.parametrize(
    ("episode", "kind", "error"),
    [
        (1, Acted, Killed),
        (2, Acted, KeyboardInterrupt),
        (2, Ended, Killed),
    ],
)
def test_a_series_that_is_cut_short_goes_on_to_the_same_end(
    episode: int,
    kind: type[Event],
    error: type[BaseException],
    own: Path,
    undisturbed: tuple[str, SeriesResult],
) -> None:
    """Digit for digit what it would have written, and a row for every episode."""
    with pytest.raises(error) as stopped:
        whole(on_event=at(episode, kind, error))
    if error is KeyboardInterrupt:
        assert str(stopped.value).endswith(f"go on with: cleancli execute --resume runs/{NAME}")
    result = resume_series((Path("runs") / NAME).absolute())
    text, expected = undisturbed
    assert own.read_text(encoding="utf-8") == text
    assert untimed(result) == untimed(expected)
    assert len(result.runs) == 3
    assert (Path("runs") / NAME / "report.html").read_text(encoding="utf-8").count("<tr data-run") == 3
    with pytest.raises(ValueError, match="has ended"):
        resume_series(Path("runs") / NAME)


@pytest.mark.parametrize("before", [True, False])
def test_a_series_that_is_killed_while_it_writes_goes_on(
    before: bool, own: Path, undisturbed: tuple[str, SeriesResult], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Before the file has changed, or right after."""
    write, written = LearningResult.write, []

    def dies(self: LearningResult, last: LearningResult | None = None) -> tuple[str, ...]:
        written.append(self)
        if len(written) == 2 and before:
            raise Killed
        paths = write(self, last)
        if len(written) == 2:
            raise Killed
        return paths

    with monkeypatch.context() as patch:
        patch.setattr(LearningResult, "write", dies)
        with pytest.raises(Killed):
            whole()
    assert own.read_text(encoding="utf-8") == written[0 if before else 1].text
    resume_series(Path("runs") / NAME)
    assert own.read_text(encoding="utf-8") == undisturbed[0]


def test_what_a_kill_left_in_an_episode_that_has_ended_is_removed(own: Path) -> None:
    """A record's last change is its end, so that a kill in it leaves a run that is not gone on with."""
    with pytest.raises(Killed):
        whole(on_event=at(2, Acted, Killed))
    ours = [
        Path("runs", NAME, "p-seed4-001", name, ".cleancli-0123456789abcdef.part") for name in ("", "state")
    ]
    for path in ours:
        path.write_text("half")
    resume_series(Path("runs") / NAME)
    assert [path for path in ours if path.exists()] == []


def test_what_a_kill_left_is_removed_also_where_nothing_is_left_to_write(own: Path) -> None:
    """A kill right after the last lesson took its place leaves what it replaced beside the domain; one in the
    page that follows leaves half a page."""
    whole()
    ours = [Path(folder, ".cleancli-0123456789abcdef.part") for folder in ("", Path("runs", NAME))]
    for path in ours:
        path.write_text("half")
    with pytest.raises(ValueError, match="has ended"):
        resume_series(Path("runs") / NAME)
    assert [path for path in ours if path.exists()] == []


def test_the_command_goes_on_with_a_series_also_where_its_run_is_named(
    own: Path, undisturbed: tuple[str, SeriesResult], capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(Killed):
        whole(on_event=at(2, Acted, Killed))
    cut_short = Path("runs") / NAME / "p-seed5-001"
    with pytest.raises(ValueError, match="resume_series"):
        resume(cut_short)
    assert run(["execute", "--resume", str(cut_short)]) in {ExitCode.DONE, ExitCode.NOT_CLEAN}
    assert own.read_text(encoding="utf-8") == undisturbed[0]
    shown = capsys.readouterr()
    assert "going on after" in shown.err
    assert f"series: runs/{NAME}/" in shown.out


def test_a_file_that_was_edited_before_a_series_goes_on_stays_as_it_is(own: Path) -> None:
    with pytest.raises(Killed):
        whole(on_event=at(2, Acted, Killed))
    edited = own.read_text(encoding="utf-8").replace("domain doors", "# mine\ndomain doors")
    own.write_text(edited, encoding="utf-8")
    with pytest.raises(Refused, match="E006"):
        resume_series(Path("runs") / NAME)
    assert own.read_text(encoding="utf-8") == edited
    own.unlink()
    with pytest.raises(ValueError, match="go on where it was begun"):
        resume_series(Path("runs") / NAME)


def test_runs_of_a_folder_are_learned_from_in_the_order_of_their_seeds(own: Path) -> None:
    """Also where a name sorts `seed10` before `seed9`: with forgetting, the last counts for most."""
    Path("before.nid").write_text(own.read_text(encoding="utf-8"), encoding="utf-8")
    whole(seed=9, episodes=2, forgetting=0.3)
    assert learn("before.nid", "runs", forgetting=0.3).text == own.read_text(encoding="utf-8")


def test_episodes_of_another_series_are_refused(own: Path) -> None:
    with pytest.raises(Killed):
        whole(on_event=at(2, Acted, Killed))
    other = whole(seed=6, episodes=2, write=False, runs="others", known=1)
    folder = Path("runs") / NAME
    (folder / "p-seed5-001").rename(folder.parent / "elsewhere")
    assert other.folder is not None
    (other.folder / "p-seed6-001").rename(folder / "p-seed6-001")
    with pytest.raises(Refused, match="not episode 2 of its series"):
        resume_series(folder)


def test_one_process_at_a_time_works_on_a_series(own: Path) -> None:
    def follow(event: Event) -> None:
        if isinstance(event, Acted):
            with pytest.raises(ValueError, match="another process"):
                resume_series(Path("runs") / NAME)

    whole(on_event=follow, episodes=2)


def test_a_series_that_is_refused_leaves_no_folder(own: Path) -> None:
    with pytest.raises(ValueError, match="goes by places"):
        whole(strategy="reactive")
    assert not list(Path("runs").iterdir())


def test_of_two_series_that_learn_into_one_file_the_later_one_is_told_and_nothing_is_lost(own: Path) -> None:
    """What the first has written stays; the records of both are there, and both count with --add."""
    others: list[SeriesResult] = []

    def follow(event: Event) -> None:
        if isinstance(event, Acted) and not others:
            others.append(whole(seed=40, runs="others", episodes=2))

    with pytest.raises(Refused) as refused:
        whole(on_event=follow)
    assert others[0].learned is not None
    assert own.read_text(encoding="utf-8") == others[0].learned.text
    (told,) = refused.value.diagnostics
    assert told.code == "E006"
    assert "cleancli learn own.nid runs/p-seed4-series-001 --add" in told.help
    learned = learn("own.nid", Path("runs") / NAME, add=True, write=True)
    counted = load_domain(Source("own.nid", learned.text)).learned
    records = [path.read_text(encoding="utf-8") for path in Path().glob("*/*/*/experience.jsonl")]
    assert counted is not None
    assert sum(each.transitions for each in counted.experience) == sum(each.count("\n") for each in records)
    assert len(counted.experience) == len(records) == 3


# ---- online equals offline

COINS = """domain coins {
  types { coin }
  predicates { heads(?c - coin) lost(?c - coin) }
  derived { hidden := count ?c - coin: not heads(?c), not lost(?c) }
  parameters { away = 0.2 }
  actions { flip(?c - coin) turn(?c - coin) }
  rule flipped: flip(?c) { when not heads(?c), not lost(?c) then away: lost(?c) 0.3: heads(?c) rest: nothing }
  rule turned: turn(?c) { when not heads(?c), not lost(?c) then away: lost(?c) 0.5: heads(?c) rest: noise }
  default { 0.9: nothing 0.1: noise }
  reward { decrease(hidden) }
}
"""
FLIPS = "problem p { domain = coins objects { a b c d - coin } init { } }"
SHIPPED = Path(__file__).parents[2]


@pytest.mark.parametrize(
    ("domain", "world", "problem", "seed", "more"),
    [
        (PULLED % "0.8", PULLED % "0.4", PROBLEM, 11, {}),
        (COINS, COINS.replace("away = 0.2", "away = 0.5"), FLIPS, 12, {"estimator": "m", "m": 4}),
        ("cleaning", None, "three_areas", 13, {"match": "strict"}),
    ],
    ids=["doors", "coins", "cleaning"],
)
def test_what_a_series_writes_is_what_learning_from_its_records_writes(
    domain: str,
    world: str | None,
    problem: str,
    seed: int,
    more: dict[str, Any],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Digit for digit, for three domains, of which two have nothing to clean."""
    monkeypatch.chdir(tmp_path)
    text = domain if "{" in domain else (SHIPPED / "domains" / f"{domain}.nid").read_text(encoding="utf-8")
    for name in ("online.nid", "offline.nid"):
        Path(name).write_text(text, encoding="utf-8")
    done = execute_series(
        "online.nid", problem, world=world, **{**ASKED, "seed": seed, "samples": 20, "episodes": 3}, **more
    )
    learn("offline.nid", *(each.folder for each in done.runs), write=True, **more)
    written = Path("online.nid").read_text(encoding="utf-8")
    assert written == Path("offline.nid").read_text(encoding="utf-8") != text
    assert done.learned is not None
    assert done.learned.text == written
    transitions = sum(each.transitions for each in done.experience)
    assert transitions == sum(each.actions for each in done.runs) > 3
