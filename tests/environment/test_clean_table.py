"""The environment as gymnasium and an agent see it."""

from __future__ import annotations

import re
import subprocess
import sys
import time
import warnings
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

import cleancli.environment
from cleancli.environment.clean_table import IMPOSSIBLE, CleanTable
from cleancli.language.diagnostics.refused import Refused

ROOT = Path(__file__).parents[2]
FEW = """
scene few {
  seed      = 3
  surface   { width = 50 cm  depth = 40 cm }
  container { edge = east  width = 24 cm }
  camera    { height = 0.6 m  image = 320 x 240  focal = 262 }
  dirt {
    group { count = 5  of = peas  at = (12 cm, 6 cm)  radius = 2 cm }
    group { count = 5  of = peas  at = (0 cm, -9 cm)  radius = 2 cm }
  }
}
"""
SPACES = ("symbolic", "physical")


@pytest.fixture(scope="module")
def few(tmp_path_factory: pytest.TempPathFactory) -> str:
    path = tmp_path_factory.mktemp("scenes") / "few.nid"
    path.write_text(FEW, encoding="utf-8")
    return str(path)


def made(scene: str, **options: Any) -> gymnasium.Env[Any, Any]:
    return gymnasium.make("cleancli/CleanTable-v0", scene=scene, **options)


def plain(env: gymnasium.Env[Any, Any]) -> CleanTable:
    table = env.unwrapped
    assert isinstance(table, CleanTable)
    return table


@pytest.mark.parametrize("actions", SPACES)
def test_gymnasium_finds_nothing_to_say(actions: str, few: str) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        check_env(made(few, actions=actions, slots=4).unwrapped)


@pytest.mark.parametrize("actions", SPACES)
def test_the_stand_in_is_the_same_environment_and_much_faster(actions: str, few: str) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        check_env(made(few, actions=actions, slots=4, simulator="stand_in").unwrapped, skip_render_check=True)
    env = made(few, actions=actions, slots=4, simulator="stand_in", truth=True, max_episode_steps=20)
    first, info = env.reset(seed=5)
    again, _ = env.reset(seed=5)
    assert all((first[name] == again[name]).all() for name in first)
    assert info["truth"]["particles"] == 10
    env.action_space.seed(5)
    spent, steps, cleaned = -time.process_time(), 0, False
    for _ in range(3 if actions == "symbolic" else 1):
        observation, info = env.reset()
        ended = False
        while not ended:
            mask = info["action_mask"] if actions == "symbolic" else None
            observation, _, terminated, truncated, info = env.step(env.action_space.sample(mask))
            assert env.observation_space.contains(observation)
            ended, steps = terminated or truncated, steps + 1
        cleaned |= terminated and info["truth"]["on_table"] == 0
    assert steps / (spent + time.process_time()) > 5
    assert cleaned or actions == "physical"


@pytest.mark.parametrize("asked", [{"image": True}, {"render_mode": "rgb_array"}, {"scene": "wam_groups"}])
def test_what_the_stand_in_has_not_is_refused(asked: dict[str, Any], few: str) -> None:
    with pytest.raises(ValueError, match="stand-in"):
        CleanTable(**{"scene": few, "simulator": "stand_in", **asked})


@pytest.mark.parametrize("actions", SPACES)
def test_a_random_agent_stays_within_the_spaces_and_is_truncated(actions: str, few: str) -> None:
    env = made(few, actions=actions, slots=4, truth=True, max_episode_steps=3)
    observation, info = env.reset(seed=5)
    env.action_space.seed(5)
    clock, ended = 0.0, False
    while not ended:
        areas = len(info["areas"])
        assert env.observation_space.contains(observation)
        mask = info["action_mask"] if actions == "symbolic" else None
        observation, reward, terminated, truncated, info = env.step(env.action_space.sample(mask))
        ended = terminated or truncated
        assert reward == areas - len(info["areas"]), "eq. 2"
        assert info["clock"] == pytest.approx(clock + info["seconds"])
        assert info["seconds"] > 1
        clock = info["clock"]
    assert terminated == info["is_success"] == (not info["areas"])
    where = [info["truth"][place] for place in ("on_table", "in_container", "in_dustpan", "on_floor")]
    assert sum(where) == info["truth"]["particles"] == 10
    env.close()


def test_the_table_can_be_cleaned_and_then_the_episode_ends(few: str) -> None:
    env = made(few, slots=4, truth=True)
    table = plain(env)
    observation, info = env.reset(seed=1)
    for _ in range(15):
        pushes = [
            number
            for number, (name, _) in enumerate(table.choices)
            if name == "moveToContainerStraight" and info["action_mask"][number]
        ]
        assert not info["is_success"]
        observation, _, terminated, _, info = env.step(pushes[0])
        if terminated:
            break
    assert terminated
    assert info["is_success"]
    assert info["areas"] == []
    assert not observation["present"].any()
    assert info["truth"]["on_table"] == 0
    assert not info["action_mask"].any()


def test_one_seed_is_one_episode(few: str) -> None:
    def episode() -> list[Any]:
        env = made(few, slots=3, image=True)
        first, info = env.reset(seed=7)
        number = int(np.flatnonzero(info["action_mask"])[0])
        second, *_ = env.step(number)
        third, again = env.reset()
        assert again["seed"] != 7
        return [first, second, third]

    for one, other in zip(episode(), episode(), strict=True):
        assert one.keys() == other.keys()
        assert all(np.array_equal(one[key], other[key]) for key in one)


def test_a_forbidden_action_changes_nothing_and_takes_no_time(few: str) -> None:
    env = made(few, slots=4)
    before, info = env.reset(seed=1)
    number = int(np.flatnonzero(info["action_mask"] == 0)[0])
    after, reward, terminated, truncated, info = env.step(number)
    assert (reward, terminated, truncated) == (0, False, False)
    assert (info["failure"], info["seconds"]) == (IMPOSSIBLE, 0)
    assert np.array_equal(before["areas"], after["areas"])


def test_a_push_that_the_robot_cannot_do_is_told_and_no_error(tmp_path: Path) -> None:
    far = tmp_path / "far.nid"
    wide = FEW.replace("few {", "far {\n  robot { drive = wam }").replace("50 cm", "120 cm")
    far.write_text(wide.replace("0.6 m", "1.2 m"), encoding="utf-8")
    env = made(str(far), actions="physical")
    env.reset(seed=1)
    *_, info = env.step(np.array([-1, 1, -1, -1], np.float32))
    assert "can't reach" in info["failure"]
    assert info["areas"]


def test_the_truth_is_told_only_when_asked_for(few: str) -> None:
    env = made(few)
    _, info = env.reset(seed=1)
    assert "truth" not in info


def test_wrong_use_is_told(few: str) -> None:
    with pytest.raises(ValueError, match="symbolic"):
        made(few, actions="verbal")
    with pytest.raises(ValueError, match="slots"):
        made(few, slots=0)
    with pytest.raises(ValueError, match="render_mode"):
        CleanTable(few, render_mode="human")
    with pytest.raises(Refused, match="E001"):
        made("no_such_scene")
    with pytest.raises(gymnasium.error.ResetNeeded):
        plain(made(few)).step(0)
    env = plain(made(few))
    env.reset(seed=1)
    with pytest.raises(ValueError, match="from 0 to"):
        env.step(-1)
    env.close()
    env.close()


def test_pictures_are_of_the_room(few: str) -> None:
    env = made(few, render_mode="rgb_array")
    env.reset(seed=1)
    picture = env.render()
    assert isinstance(picture, np.ndarray)
    assert (picture.shape, picture.dtype) == ((480, 640, 3), np.dtype(np.uint8))
    assert picture.std() > 10


def test_importing_registers() -> None:
    assert gymnasium.spec("cleancli/CleanTable-v0").max_episode_steps == cleancli.environment.MOST_ACTIONS


@pytest.mark.needs_pybullet
def test_the_examples_of_the_documents_run(few: str) -> None:
    text = (ROOT / "docs" / "gym.md").read_text(encoding="utf-8")
    example, *symbolic = re.findall(r"^```python\n(.*?)^```$", text, re.M | re.S)
    for each in symbolic:
        exec(compile(each, "docs/gym.md", "exec"), {})
    assert len(symbolic) == 2
    shorter = example.replace('"two_groups"', repr(few))
    assert shorter != example
    command = [sys.executable, "-W", "error::UserWarning", "-c", shorter]
    result = subprocess.run(command, capture_output=True, text=True)
    assert result.returncode == 0, result.stderr
    assert "seconds" in result.stdout
