"""`cleancli act`, as a user runs it."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from scipy.stats import binomtest

from cleancli.cli.commands.act import in_order
from cleancli.cli.main import run

SMALL = """scene small {
  camera { image = 320 x 240  focal = 262 }
  grasp own { flap = 3 cm }
  dirt { group { count = 6  at = (30 cm, 0 cm)  radius = 2 cm } }
}
"""


@pytest.fixture
def scene(tmp_path: Path) -> str:
    path = tmp_path / "small.nid"
    path.write_text(SMALL, encoding="utf-8")
    return str(path)


def test_outcomes_by_grasp_as_data_and_as_a_picture(
    scene: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    picture = tmp_path / "map.png"
    words = ["act", scene, "moveToContainerFast", "--repeat", "2", "--json", "--plot", str(picture)]
    assert run([*words, "--grasp", "folded", "--grasp", "own"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert [grasp["grasp"] for grasp in found["grasps"]] == ["folded", "own"]
    assert [grasp["width"] for grasp in found["grasps"]] == [0.088, 0.12]
    for grasp in found["grasps"]:
        assert [trial["seed"] for trial in grasp["trials"]] == [1, 2]
        assert sum(outcome["trials"] for outcome in grasp["outcomes"].values()) == 2
        for outcome in grasp["outcomes"].values():
            expected = binomtest(outcome["trials"], 2).proportion_ci(0.95, method="wilson")
            assert outcome["share"] == outcome["trials"] / 2
            assert (outcome["low"], outcome["high"]) == pytest.approx((expected.low, expected.high), abs=1e-4)
    assert picture.read_bytes().startswith(b"\x89PNG")


def test_outcomes_as_a_table(scene: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["act", scene, "groupScattered", "--repeat", "1", "--seed", "7"]) == 0
    said = capsys.readouterr().out.splitlines()
    assert said[0] == "groupScattered, gantry, grasp wide of 12 cm"
    assert [line.split("  ")[0] for line in said[2:5]] == ["none left", "some left", "spread out"]


def test_why_a_motion_failed_is_told(scene: str, capsys: pytest.CaptureFixture[str]) -> None:
    far = Path(scene)
    far.write_text(SMALL.replace("(30 cm, 0 cm)", "(-30 cm, 0 cm)"), encoding="utf-8")
    words = ["act", scene, "moveToContainerFast", "--repeat", "2", "--robot", "reem"]
    assert run(words) == 0
    assert "cm too far" in capsys.readouterr().out
    assert run([*words, "--json"]) == 0
    (grasp,) = json.loads(capsys.readouterr().out)["grasps"]
    assert all("cm too far" in trial["failure"] for trial in grasp["trials"])


def test_several_jobs_keep_the_order() -> None:
    assert list(in_order(str, range(4), 2)) == list(in_order(str, range(4), 1)) == ["0", "1", "2", "3"]


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["moveToContainerFats"], "did you mean `moveToContainerFast`"),
        (["join2", "--areas", "a1"], "join2 takes 2 different areas"),
        (["join2", "--areas", "a1, a1"], "join2 takes 2 different areas"),
        (["join2", "--grasp", "foldet"], "did you mean `folded`"),
        (["join2", "--plot", "no/folder/map.png"], "there is no folder `no/folder`"),
        (["pickUp"], "`gantry` can't pickUp; it takes --robot reem"),
    ],
)
def test_what_cannot_be_tried_is_said_at_once(
    scene: str, words: list[str], said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(["act", scene, *words]) == 2
    assert said in capsys.readouterr().err
