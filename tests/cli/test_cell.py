"""`cleancli cell`: from a printed board to the file that says where camera and robot stand."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner, Result

from cleancli.cell.board import BOARDS
from cleancli.cell.camera import Laid, Sighted, sighted
from cleancli.cell.cell_file import BadCell, read_cell
from cleancli.cli.exit_codes import ExitCode
from cleancli.cli.main import cli, run
from cleancli.geometry.rgbd import Frame
from cleancli.perception.recorded import save_frames
from support import board_pictures, real_camera
from support.board_pictures import errors, looking

POSE = looking(0.9, slant=10, towards=200, yaw=170)
LAID = Laid((0.05, -0.1), np.radians(20))


@pytest.fixture
def recorded(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Two pictures of the board, in a folder of which nobody knows where the camera stood."""
    monkeypatch.chdir(tmp_path)
    rng = np.random.default_rng(5)
    save_frames([board_pictures.picture(BOARDS["a3"], LAID, POSE, rng) for _ in range(2)], Path("pictures"))
    return tmp_path


def camera(*words: str) -> int:
    laid = ["--at", "5", "-10", "--turn", "20"]
    return run(["cell", "camera", "two_groups", "pictures", "--out", "cell.json", *laid, *words])


def test_the_camera_stands_where_the_pictures_were_drawn_from(
    recorded: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert camera() == 0
    told = capsys.readouterr()
    assert told.err == ""
    assert "cell.json: the camera stands at (" in told.out
    assert "10.0 degrees off looking straight down" in told.out
    assert "board a3: 56 corners in 2 of 2 pictures" in told.out
    place = read_cell(recorded / "cell.json").camera
    assert place is not None
    millimetres, degrees = errors(np.array(place.pose), POSE)
    assert millimetres < 2
    assert degrees < 0.1
    assert camera("--json") == 0
    assert json.loads(capsys.readouterr().out)["pose"] == pytest.approx(np.array(place.pose))


def test_what_the_file_says_already_stays(recorded: Path) -> None:
    """The table's place comes from touching it, and is not lost when the camera is moved."""
    assert camera() == 0
    cell = json.loads((recorded / "cell.json").read_text())
    cell["table"] = {"pose": np.eye(4).tolist(), "spread": 0.001}
    (recorded / "cell.json").write_text(json.dumps(cell))
    assert camera("--seed", "3") == 0
    kept = read_cell(recorded / "cell.json")
    assert kept.table is not None
    assert kept.table.spread == 0.001
    assert kept.camera is not None


def test_recordings_that_do_not_tell_where_the_camera_stands_are_read_with_the_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Dirt is found where it lies; without the file, places are those of the table's outline."""
    monkeypatch.chdir(tmp_path)
    frame = real_camera.taken(1)
    save_frames([frame], Path("look"))
    described = json.loads(Path("look/camera.json").read_text())
    pose = described.pop("pose")
    Path("look/camera.json").write_text(json.dumps(described))
    place = {"pose": pose, "misfit": 0.1}
    Path("cell.json").write_text(json.dumps({"format": "cleancli cell 1", "camera": place}))

    def areas(*words: str) -> object:
        assert run(["perceive", "look", "--json", *words]) == 0
        return json.loads(capsys.readouterr().out)["looks"][0]["areas"]

    with_file = areas("--cell", "cell.json")
    described["pose"] = pose
    Path("look/camera.json").write_text(json.dumps(described))
    assert areas() == with_file
    # Who tells it himself knows better: a camera on an arm moves.
    Path("cell.json").write_text(
        json.dumps({"format": "cleancli cell 1", "camera": place | {"pose": shifted(pose)}})
    )
    assert areas("--cell", "cell.json") == with_file
    assert (
        run(["calibrate", "two_groups", "--frames", "look", "--cell", "no.json", "--out", "t.json"])
        == ExitCode.FILES
    )
    assert "no.json" in capsys.readouterr().err


def shifted(pose: object) -> object:
    moved = np.array(pose)
    moved[0, 3] += 0.1
    rows: object = moved.tolist()
    return rows


@pytest.mark.parametrize(
    ("words", "code", "told"),
    [
        (["--at", "40", "0"], ExitCode.USAGE, "the board would lie"),
        (["--bar", "20"], ExitCode.USAGE, "20"),
        (["--out", "no/cell.json"], ExitCode.USAGE, "there is no folder"),
        (["--out", "pictures/camera.json"], ExitCode.USAGE, "exists, and it describes no cell"),
    ],
)
def test_what_cannot_be_is_refused_before_anything_is_written(
    words: list[str], code: int, told: str, recorded: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    before = (recorded / "pictures" / "camera.json").read_text()
    assert camera(*words) == code
    assert told in " ".join(capsys.readouterr().err.split())
    assert not (recorded / "cell.json").exists()
    assert (recorded / "pictures" / "camera.json").read_text() == before


def test_pictures_without_a_board_end_with_a_message(
    recorded: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    save_frames([real_camera.taken(1)], recorded / "table")
    assert run(["cell", "camera", "two_groups", "table", "--out", "cell.json"]) == ExitCode.FILES
    assert "table: no picture shows 6 corners of a board" in capsys.readouterr().err
    assert not (recorded / "cell.json").exists()


def test_a_newer_edit_of_the_file_is_not_overwritten(
    recorded: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Somebody saves the file while the board is looked for."""
    assert camera() == 0
    newer = (recorded / "cell.json").read_text() + "\n"

    def meanwhile(frames: Sequence[Frame], laid: Laid, rng: np.random.Generator) -> Sighted:
        (recorded / "cell.json").write_text(newer)
        return sighted(frames, laid, rng)

    monkeypatch.setattr("cleancli.cli.commands.cell.sighted", meanwhile)
    assert camera() == ExitCode.REFUSED
    assert "E006" in capsys.readouterr().err
    assert (recorded / "cell.json").read_text() == newer


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("[]", "it describes no cell"),
        ("{", "it is no JSON"),
        ('{"camera": {"x": ' + "[" * 5000, "it is nested too deeply"),
        ('{"format": "cleancli cell 9"}', "its `format` is not"),
        ('{"format": "cleancli cell 1", "camra": {}}', "camra"),
        ('{"format": "cleancli cell 1", "camera": {"pose": 1, "misfit": 0}}', "it describes no cell"),
        (
            json.dumps(
                {"format": "cleancli cell 1", "table": {"pose": (2 * np.eye(4)).tolist(), "spread": None}}
            ),
            "the `pose` of its `table` must be a rotation",
        ),
        (
            json.dumps(
                {"format": "cleancli cell 1", "camera": {"pose": shifted(1e4 * np.eye(4)), "misfit": 0}}
            ),
            "the `pose` of its `camera` must be a rotation",
        ),
    ],
)
def test_a_file_that_describes_no_cell_is_refused(text: str, told: str, tmp_path: Path) -> None:
    file = tmp_path / "cell.json"
    file.write_text(text)
    with pytest.raises(BadCell, match=told) as refused:
        read_cell(file)
    assert str(file) in str(refused.value)


def test_the_board_is_written_for_both_papers(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    for paper, size in (("a3", 'width="420mm" height="297mm"'), ("a4", 'width="297mm" height="210mm"')):
        assert run(["cell", "board", "--out", f"{paper}.svg", "--paper", paper]) == 0
        assert "measure the bar: 200 mm" in capsys.readouterr().out
        assert size in Path(f"{paper}.svg").read_text()
    assert run(["cell", "board", "--out", "no/such/folder.svg"]) == ExitCode.FILES
    assert run(["cell", "bord", "--out", "x.svg"]) == ExitCode.USAGE


TABLE = np.array([[0.0, -1.0, 0.0, 0.6], [1.0, 0.0, 0.0, -0.1], [0.0, 0.0, 1.0, 0.02], [0, 0, 0, 1.0]])
"""The robot stands south of the table and looks north: the scene's x is its y."""


def tool(x: float, y: float) -> str:
    """What the robot tells, in mm, where it touches a place of the scene."""
    return " ".join(f"{1000 * side:.2f}" for side in (TABLE @ (x, y, 0.0, 1.0))[:3])


def asked(*answers: str, words: tuple[str, ...] = ("--unit", "mm")) -> Result:
    words = ("cell", "touch", "two_groups", "touches.csv", "--out", "cell.json", "--ask", *words)
    return CliRunner().invoke(cli, words, input="".join(f"{answer}\n" for answer in answers))


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return tmp_path


CORNERS = {"a1": (-0.144, -0.072), "g1": (0.144, -0.072), "g4": (0.144, 0.072), "a4": (-0.144, 0.072)}
PLACES = [(-0.4, -0.3), (0.4, -0.3), (0.4, 0.3), (-0.4, 0.3)]


def test_touches_are_asked_for_and_tell_where_the_table_is(folder: Path) -> None:
    answers = [*(tool(*place) for place in CORNERS.values()), *(tool(*place) for place in PLACES), ""]
    result = asked(*answers)
    assert result.exit_code == 0, result.output
    asks = [line for line in result.output.split("touch ") if line.startswith("corner ")]
    assert [ask.split()[1] for ask in asks] == list(CORNERS)
    assert "8 touches, 0.0" in result.output
    place = read_cell(folder / "cell.json").table
    assert place is not None
    assert errors(np.array(place.pose), TABLE)[0] < 0.1
    # Read again from the file, and told for programs.
    words = ["cell", "touch", "two_groups", "touches.csv", "--out", "again.json", "--json"]
    again = CliRunner().invoke(cli, words)
    assert json.loads(again.output)["pose"] == pytest.approx(np.array(place.pose))
    assert len(json.loads(again.output)["residuals"]) == 8


def test_what_was_typed_is_kept_whatever_comes_after(folder: Path) -> None:
    """An answer that is no touch is asked for again; what was touched before is not lost, nor asked for."""
    first = asked(tool(*CORNERS["a1"]), "1 2", "x y z", tool(*CORNERS["g1"]))
    assert first.exit_code != 0
    assert "must begin with three numbers" in first.output
    assert (folder / "touches.csv").read_text().splitlines() == [
        "x_mm,y_mm,z_mm,corner",
        f"{tool(*CORNERS['a1']).replace(' ', ',')},a1",
        f"{tool(*CORNERS['g1']).replace(' ', ',')},g1",
    ]
    assert not (folder / "cell.json").exists()
    rest = asked("", tool(*CORNERS["a4"]), *(tool(*place) for place in PLACES), "", words=())
    assert rest.exit_code == 0, rest.output
    assert "corner a1" not in rest.output
    assert "7 touches" in rest.output


def test_files_of_touches_that_tell_nothing_end_with_a_message(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = ["cell", "touch", "two_groups", "touches.csv", "--out", "cell.json"]
    assert run(words) == ExitCode.REFUSED
    assert "no file `touches.csv`" in capsys.readouterr().err
    for text, told in (
        ("1,2,3\n", "touches.csv: line 1: the header must be"),
        ("x_m,y_m,z_m,corner\n1,2,3,z9\n", "touches.csv: line 2: the board a3 has no corner `z9`"),
        ("x_m,y_m,z_m,corner\n1,2,3,a1\n", "touches.csv: 3 touches at least"),
    ):
        (folder / "touches.csv").write_text(text)
        assert run(words) == ExitCode.FILES
        assert told in capsys.readouterr().err
        assert not (folder / "cell.json").exists()


@pytest.fixture
def cell(folder: Path) -> Path:
    """A file that is right for a recorded table, and for touches."""
    frames = [real_camera.taken(seed) for seed in range(2)]
    save_frames(frames, folder / "table")
    described = json.loads((folder / "table" / "camera.json").read_text())
    del described["pose"]
    (folder / "table" / "camera.json").write_text(json.dumps(described))
    parts = {
        "camera": {"pose": frames[0].camera.pose.tolist(), "misfit": 0.1},
        "table": {"pose": TABLE.tolist(), "spread": 0.001},
    }
    (folder / "cell.json").write_text(json.dumps({"format": "cleancli cell 1"} | parts))
    places = [("a1", CORNERS["a1"]), *(("", place) for place in PLACES)]
    lines = [f"{tool(*place).replace(' ', ',')},{name}" for name, place in places]
    (folder / "again.csv").write_text("\n".join(["x_mm,y_mm,z_mm,corner", *lines]) + "\n")
    return folder / "cell.json"


CHECK = ["cell", "check", "two_groups", "cell.json", "--frames", "table", "--touches", "again.csv"]


def test_a_cell_that_is_right_is_told_with_what_was_measured(
    cell: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(CHECK) == 0
    told = capsys.readouterr()
    assert told.err == ""
    assert "the camera sees the table" in told.out
    assert "the tool touches the table +0.00 mm above its place, and 0.0 mm beside corners" in told.out
    assert run([*CHECK, "--json"]) == 0
    data = json.loads(capsys.readouterr().out)
    assert data["faults"] == []
    assert data["seen"]["shifted"] == pytest.approx([0, 0], abs=0.002)


def test_what_of_a_cell_cannot_be_right_is_told_with_exit_code_1(
    cell: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    known = json.loads(cell.read_text())
    known["camera"]["pose"] = shifted(known["camera"]["pose"])
    known["table"]["pose"][2][3] += 0.004
    cell.write_text(json.dumps(known))
    assert run(CHECK) == ExitCode.REFUSED
    told = " ".join(capsys.readouterr().err.split())
    assert "error: the table's middle is seen 100 mm east of its place" in told
    assert "error: the tool touches the table 4.0 mm lower than the cell says" in told
    assert run([*CHECK, "--json"]) == ExitCode.REFUSED
    assert len(json.loads(capsys.readouterr().out)["faults"]) == 2


def test_what_a_check_needs_is_asked_for(cell: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(CHECK[:4]) == ExitCode.USAGE
    assert "there is nothing to check by" in capsys.readouterr().err
    cell.write_text('{"format": "cleancli cell 1"}')
    assert run(CHECK[:6]) == ExitCode.FILES
    assert "cell.json: it does not say where the camera stands" in capsys.readouterr().err
    assert run([*CHECK[:4], *CHECK[6:]]) == ExitCode.FILES
    assert "cell.json: it does not say where the table is" in capsys.readouterr().err
    cell.unlink()
    assert run(CHECK) == ExitCode.FILES
