"""Domains and problems as Gymnasium environments: what an agent meets is what the rules say."""

from __future__ import annotations

import time
import warnings
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env
from gymnasium.vector import AutoresetMode, SyncVectorEnv
from scipy.stats import binomtest

import cleancli
import cleancli.environment
from cleancli.compiler import semantics
from cleancli.compiler.task import held
from cleancli.environment.symbolic import Symbolic, SymbolicVector
from cleancli.language.diagnostics.refused import Refused

NAME = "cleancli/Symbolic-v0"
LAMPS = """domain lamps {
  types { lamp }
  predicates { lit(?l - lamp) broken(?l - lamp) dark() }
  derived { unlit := count ?l - lamp: not lit(?l) }
  actions { press(?l - lamp) [cost = 0.5]  shout() }
  rule pressed: press(?l) { when not lit(?l), not broken(?l) then 0.3: lit(?l) 0.1: broken(?l) rest: nothing }
  rule shouted: shout() { when not dark() then 0.5: dark() rest: nothing }
  reward { decrease(unlit) }
}
"""
NOTHING = """domain lamps {
  types { lamp }
  predicates { lit(?l - lamp) broken(?l - lamp) dark() }
  actions { press(?l - lamp) }
  rule pressed: press(?l) { when broken(?l) then 0.3: lit(?l), dark() rest: nothing }
  reward { goal }
}
"""
PROBLEM = "problem p { domain = lamps objects { a b - lamp } init { } %s }"


@pytest.fixture
def lamps(tmp_path: Path) -> str:
    """A problem of two lamps, of which any may break."""
    (tmp_path / "lamps.nid").write_text(LAMPS, encoding="utf-8")
    (tmp_path / "p.nid").write_text(PROBLEM % "", encoding="utf-8")
    return str(tmp_path / "p.nid")


def with_goal(lamps: str, goal: str, rules: str = LAMPS) -> str:
    Path(lamps).write_text(PROBLEM % f"goal {{ {goal} }} horizon = 9", encoding="utf-8")
    Path(lamps).with_name("lamps.nid").write_text(rules, encoding="utf-8")
    return lamps


def single(problem: str, **options: Any) -> Symbolic:
    env = gymnasium.make(NAME, problem=problem, **options).unwrapped
    assert isinstance(env, Symbolic)
    return env


def many(problem: str, number: int, **options: Any) -> SymbolicVector:
    how = "vector_entry_point"
    env = gymnasium.make_vec(NAME, number, how, problem=problem, **options)
    assert isinstance(env, SymbolicVector)
    return env


def random_actions(env: SymbolicVector, info: dict[str, Any], rng: np.random.Generator) -> Any:
    mask = info["action_mask"]
    return (rng.random(mask.shape) * (mask + 1e-9)).argmax(axis=1)


@pytest.mark.parametrize("observation", ["array", "facts"])
def test_gymnasium_finds_nothing_to_say(observation: str) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        check_env(
            gymnasium.make(NAME, problem="three_areas", observation=observation, render_mode="ansi").unwrapped
        )


def test_observations_say_what_the_problem_says(lamps: str) -> None:
    env = single(lamps, observation="facts", render_mode="ansi")
    observation, info = env.reset(seed=1)
    assert observation == dict.fromkeys(["broken(a)", "broken(b)", "dark()", "lit(a)", "lit(b)"], 0)
    assert dict(zip(env.choices, info["action_mask"], strict=True)) == {
        "press(a)": 1,
        "press(b)": 1,
        "shout()": 1,
    }
    assert env.render() == ""
    while not observation["dark()"]:
        observation, reward, *_, info = env.step(env.choices.index("shout()"))
        assert reward == 0
    assert env.render() == "dark()"
    assert not info["action_mask"][env.choices.index("shout()")]
    assert env.action_masks().tolist() == [bool(each) for each in info["action_mask"]]


def test_every_step_is_one_that_the_rules_allow_and_is_paid_as_they_say() -> None:
    """Against the slow meaning of rules and rewards, state by state, over hundreds of episodes."""
    env, rng = many("three_areas", 50, max_actions=6), np.random.default_rng(1)
    task, ended = env.task, np.zeros(50, bool)
    before, info = env.reset(seed=7)
    ends = 0
    for _ in range(40):
        actions = random_actions(env, info, rng)
        left = 6 - env._batch.steps - 1
        after, rewards, terminated, truncated, info = env.step(actions)
        for place in range(50):
            was, now = tuple(before[place].tolist()), tuple(after[place].tolist())
            covered = [
                semantics.covering_rule(task, now, action) is not None for action in range(len(task.actions))
            ]
            assert info["action_mask"][place].tolist() == covered
            if ended[place]:
                assert (now, rewards[place]) == (task.initial, 0)
                continue
            assert now in semantics.forward(task, {was: 1.0}, int(actions[place]))
            assert task.counted is not None
            over = held(task.counted, now) == 0 or not any(covered)
            assert bool(terminated[place]) is over
            paid = semantics.reward(task, was, int(actions[place]), now)
            rest = left[place] * semantics.standing(task, now) if over else 0.0
            assert rewards[place] == pytest.approx(paid + rest)
        ended = terminated | truncated
        ends += int(ended.sum())
        before = after
    assert ends > 100


def test_outcomes_come_as_often_as_they_are_declared(lamps: str) -> None:
    env = many(lamps, 20_000)
    env.reset(seed=3)
    observation, *_ = env.step(np.full(20_000, env.choices.index("press(a)")))
    names = list(single(lamps, observation="facts").reset()[0])
    for fact, declared in (("lit(a)", 0.3), ("broken(a)", 0.1)):
        came = int(observation[:, names.index(fact)].sum())
        assert binomtest(came, 20_000, declared).pvalue > 1e-3


def test_the_rewards_of_an_episode_add_up_to_the_return_that_simulating_gives(lamps: str) -> None:
    """With a goal, and a count that is paid for in each step."""
    held_on = LAMPS.replace("derived {", "derived { bright := count ?l - lamp: lit(?l)")
    problem = with_goal(lamps, "lit(a)", held_on.replace("decrease(unlit)", "2 * bright"))
    env = many(problem, 4000, max_actions=9)
    env.reset(seed=5)
    press, totals = env.choices.index("press(a)"), np.zeros(4000)
    over = np.zeros(4000, bool)
    for _ in range(9):
        _, rewards, terminated, truncated, _ = env.step(np.full(4000, press))
        totals += np.where(over, 0, rewards)
        over |= terminated | truncated
    task, expected = env.task, 0.0
    chances = {task.initial: 1.0}
    for left in reversed(range(9)):
        after: dict[Any, float] = {}
        for state, chance in chances.items():
            for now, share in semantics.forward(task, {state: 1.0}, press).items():
                goes_on = not semantics.reaches_goal(task, now)
                rest = 0.0 if goes_on else left * semantics.standing(task, now)
                expected += chance * share * (semantics.reward(task, state, press, now) + rest)
                if goes_on:
                    after[now] = after.get(now, 0.0) + chance * share
        chances = after
    assert abs(totals.mean() - expected) < 4 * totals.std() / np.sqrt(4000)


def test_each_of_many_goes_as_one_alone_with_its_seed(lamps: str) -> None:
    env, rng = many(lamps, 3, max_actions=5), np.random.default_rng(2)
    _, info = env.reset(seed=11)
    alone = [single(lamps, max_actions=5) for _ in range(3)]
    for place, one in enumerate(alone):
        one.reset(seed=11 + place)
    ended = np.zeros(3, bool)
    for _ in range(60):
        actions = random_actions(env, info, rng)
        observation, rewards, terminated, truncated, info = env.step(actions)
        for place, one in enumerate(alone):
            if ended[place]:
                told, own = one.reset()
                step: tuple[Any, ...] = (told, 0.0, False, False, own)
            else:
                step = one.step(int(actions[place]))
            assert step[0].tolist() == observation[place].tolist()
            assert step[1:4] == (rewards[place], terminated[place], truncated[place])
            assert step[4]["action_mask"].tolist() == info["action_mask"][place].tolist()
            assert step[4]["is_success"] == info["is_success"][place]
        ended = terminated | truncated


def test_an_episode_may_begin_anew_at_once(lamps: str) -> None:
    """As `SyncVectorEnv` of Gymnasium tells it by `AutoresetMode.SAME_STEP`."""
    env = many(lamps, 3, max_actions=5, autoreset_mode="SameStep")
    assert env.metadata["autoreset_mode"] is AutoresetMode.SAME_STEP
    makers = [lambda: gymnasium.make(NAME, problem=lamps, max_actions=5)] * 3
    reference = SyncVectorEnv(makers, autoreset_mode="SameStep")
    rng, ends = np.random.default_rng(2), 0
    (first, info), (expected, _) = env.reset(seed=11), reference.reset(seed=11)
    assert first.tolist() == expected.tolist()
    for _ in range(60):
        actions = random_actions(env, info, rng)
        *step, info = env.step(actions)
        *expected_step, expected_info = reference.step(actions)
        for told, wanted in zip(step, expected_step, strict=True):
            assert told.tolist() == wanted.tolist()
        assert info["action_mask"].tolist() == expected_info["action_mask"].tolist()
        assert ("final_obs" in info) is ("final_obs" in expected_info) is bool((step[2] | step[3]).any())
        for place in np.flatnonzero(step[2] | step[3]):
            assert info["_final_obs"][place]
            assert info["final_obs"][place].tolist() == expected_info["final_obs"][place].tolist()
            masks = info["final_info"]["action_mask"], expected_info["final_info"]["action_mask"]
            assert masks[0][place].tolist() == masks[1][place].tolist()
            succeeded = info["final_info"]["is_success"], expected_info["final_info"]["is_success"]
            assert succeeded[0][place] == succeeded[1][place]
            ends += 1
    assert ends > 20
    with pytest.raises(ValueError, match="autoreset_mode"):
        SymbolicVector(2, lamps, autoreset_mode=AutoresetMode.DISABLED)


@pytest.mark.parametrize("goal", ["", "lit(a), lit(b)"])
def test_an_episode_succeeds_where_nothing_is_left_to_do(lamps: str, goal: str) -> None:
    """Also one with a goal that ends otherwise: both lamps are broken, and nobody can shout any more."""
    problem = with_goal(lamps, goal) if goal else lamps
    env, rng = many(problem, 100, max_actions=12), np.random.default_rng(3)
    lit = [env.facts.index(f"lit({name})") for name in "ab"]
    observation, info = env.reset(seed=1)
    assert not info["is_success"].any()
    ended, seen = np.zeros(100, bool), set()
    for _ in range(30):
        observation, _, terminated, truncated, info = env.step(random_actions(env, info, rng))
        done = (observation[:, lit] == 1).all(axis=1) & ~ended
        assert info["is_success"].tolist() == done.tolist()
        ended = terminated | truncated
        seen |= set(zip(terminated[ended].tolist(), done[ended].tolist(), strict=True))
    assert seen == {(True, True), (True, False), (False, False)}


def test_the_numbers_of_an_observation_have_names(lamps: str) -> None:
    env = single(lamps)
    assert set(env.facts) == {"lit(a)", "lit(b)", "broken(a)", "broken(b)", "dark()"}
    observation, _ = env.reset(seed=1)
    facts, _ = single(lamps, observation="facts").reset(seed=1)
    assert dict(zip(env.facts, observation.tolist(), strict=True)) == facts
    assert many(lamps, 2).facts == env.facts


def test_a_goal_that_cannot_be_reached_ends_nothing_but_the_patience(lamps: str) -> None:
    """Nor do facts that the reward counts end an episode of a problem that has a goal."""
    problem = with_goal(lamps, "lit(a), broken(a), dark()")
    env = many(problem, 200, max_actions=30)
    _, info = env.reset(seed=1)
    rng, ended = np.random.default_rng(1), np.zeros(200, bool)
    for _ in range(29):
        _, _, terminated, _, info = env.step(random_actions(env, info, rng))
        assert bool((terminated == ~info["action_mask"].any(axis=1)).all())
        ended |= terminated
    assert ended.any()


def test_what_no_action_can_change_is_counted_to_the_end(lamps: str) -> None:
    """Of two lamps that are unlit only one can be pressed: an episode ends where nothing can be done."""
    near = LAMPS.replace("dark() }", "dark() near(?l - lamp) [static] }")
    near = near.replace("when not lit(?l)", "when near(?l), not lit(?l)").replace(
        "  rule shouted", "  # rule"
    )
    Path(lamps).with_name("lamps.nid").write_text(near, encoding="utf-8")
    Path(lamps).write_text(PROBLEM.replace("init { }", "init { near(a) }") % "", encoding="utf-8")
    env = single(lamps, observation="facts")
    observation, info = env.reset(seed=1)
    terminated = False
    while not terminated:
        assert env.action_masks().any()
        observation, _, terminated, truncated, info = env.step(env.choices.index("press(a)"))
        assert not truncated
    assert observation["lit(a)"] or observation["broken(a)"]
    assert not info["action_mask"].any()


def test_a_problem_that_is_nearly_named_is_told(lamps: str) -> None:
    wrong = lamps.replace("p.nid", "pp.nid")
    with pytest.raises(Refused) as refused:
        Symbolic(wrong)
    (found,) = refused.value.diagnostics
    assert str(found.help).startswith(f"did you mean `{lamps}`")


def test_what_cannot_be_learned_from_is_refused_in_words(lamps: str) -> None:
    with pytest.raises(ValueError, match="nothing is left to do in `p` from the beginning"):
        single(with_goal(lamps, "not dark()"))
    with pytest.raises(ValueError, match="no action can change anything in `p`"):
        single(with_goal(lamps, "dark()", NOTHING))
    with pytest.raises(Refused, match="no file `lampz`"):
        single("lampz")
    for wrong in ({"observation": "facst"}, {"max_actions": 0}, {"render_mode": "human"}):
        with pytest.raises((ValueError, gymnasium.error.Error), match=r"observation|max_actions|render_mode"):
            Symbolic("three_areas", **wrong)
    env = many("three_areas", 2)
    with pytest.raises(gymnasium.error.ResetNeeded):
        env.step(np.zeros(2, int))
    env.reset(seed=[1, 2])
    for actions in (np.zeros(3, int), np.array([0, 99]), np.zeros(2)):
        with pytest.raises(ValueError, match="action"):
            env.step(actions)
    with pytest.raises(ValueError, match="2 seeds"):
        env.reset(seed=[1])
    alone = single("three_areas")
    with pytest.raises(gymnasium.error.ResetNeeded):
        alone.step(0)
    alone.reset(seed=1)
    with pytest.raises(ValueError, match="from 0 to"):
        alone.step(99)


def test_hundred_thousand_steps_a_second() -> None:
    """In a batch of 256 on one core, with the masks that each step tells; medians of five."""
    env, rng = many("three_areas", 256), np.random.default_rng(1)
    _, info = env.reset(seed=1)
    rates = []
    for _ in range(5):
        spent = -time.process_time()
        for _ in range(100):
            *_, info = env.step(random_actions(env, info, rng))
        rates.append(256 * 100 / (spent + time.process_time()))
    assert np.median(rates) > 100_000


def test_a_learner_of_tables_comes_near_the_planner() -> None:
    """Q-learning (Watkins 1989) in the vectorised world: after 60,000 steps it returns more than acting at
    random, and nearly what the best policy does."""
    env, rng = many("three_areas", 256, max_actions=4), np.random.default_rng(4)
    sizes = np.array([len(variable.values) for variable in env.task.variables])
    places = np.concatenate([[1], np.cumprod(sizes)[:-1]])
    table = np.zeros((int(np.prod(sizes)), len(env.choices)))
    seen = np.zeros_like(table)

    def played(explore: float, steps: int) -> float:
        observation, info = env.reset(seed=int(rng.integers(2**31)))
        fresh, returns, total = np.zeros(256, bool), [], np.zeros(256)
        for _ in range(steps):
            state, mask = observation @ places, info["action_mask"] == 1
            best = np.where(mask, table[state] + 1e-6 * rng.random(mask.shape), -np.inf).argmax(axis=1)
            action = np.where(rng.random(256) < explore, random_actions(env, info, rng), best)
            observation, reward, terminated, truncated, info = env.step(action)
            total += reward
            later = np.where(info["action_mask"] == 1, table[observation @ places], -np.inf).max(axis=1)
            target = reward + np.where(terminated, 0.0, np.where(np.isfinite(later), 0.9 * later, 0.0))
            learning = np.flatnonzero(~fresh)
            for place in learning[: 256 if explore else 0]:
                cell = state[place], action[place]
                seen[cell] += 1
                table[cell] += (target[place] - table[cell]) / seen[cell] ** 0.6
            fresh = terminated | truncated
            returns += total[fresh].tolist()
            total[fresh] = 0.0
        return float(np.mean(returns))

    random_return = played(1.0, 60)
    for explore in (1.0, 0.5, 0.2):
        played(explore, 60)
    learned = played(0.0, 60)
    best = cleancli.plan("cleaning", "three_areas", planner="exact").value
    assert learned > random_return
    assert learned > 0.97 * best


def test_the_table_has_masks_where_learners_look_for_them(tmp_path: Path) -> None:
    env = gymnasium.make("cleancli/CleanTable-v0", scene="two_groups", slots=4).unwrapped
    _, info = env.reset(seed=1)
    assert env.action_masks().tolist() == (info["action_mask"] == 1).tolist()  # type: ignore[attr-defined]
    env.close()
