"""Train MaskablePPO of sb3-contrib on any domain and problem: python examples/train_symbolic.py [PROBLEM]

    pip install '.[gym]' sb3-contrib

in the folder of the source first; torch, which sb3-contrib needs, takes some 3 GB with its CUDA libraries.
It trains for five minutes of CPU time on one core unless `--minutes` says otherwise, and prints every half
minute what episodes of the policy return in the mean, beside those of actions drawn at random.
"""

from __future__ import annotations

import argparse
import json
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import torch
from gymnasium.vector import AutoresetMode
from sb3_contrib import MaskablePPO
from stable_baselines3.common.callbacks import BaseCallback
from stable_baselines3.common.vec_env import VecEnv

HERE = Path(__file__).parent
EPISODES = 256
"""How many are carried out side by side, and how many a policy is valued by."""


def opened(problem: str, number: int) -> Any:
    """So many episodes of a problem, which begin anew at once where they end."""
    return gymnasium.make_vec(
        "cleancli.environment:cleancli/Symbolic-v0",
        num_envs=number,
        vectorization_mode="vector_entry_point",
        problem=problem,
        autoreset_mode=AutoresetMode.SAME_STEP,
    )


class SideBySide(VecEnv):
    """The vectorised environment of Gymnasium as Stable-Baselines3 asks for one."""

    def __init__(self, env: Any) -> None:
        self.env = env  # VecEnv asks it for its `render_mode`
        super().__init__(env.num_envs, env.single_observation_space, env.single_action_space)

    def reset(self) -> Any:
        """Begin all episodes; (num_envs, V) observations."""
        observation, _ = self.env.reset(seed=self._seeds[0])
        self._reset_seeds()
        return observation

    def step_async(self, actions: Any) -> None:
        """Keep the actions for `step_wait`."""
        self.actions = actions

    def step_wait(self) -> Any:
        """A step of each, with the last observation of the episodes that are over where it is looked for."""
        observation, rewards, terminated, truncated, info = self.env.step(self.actions)
        told: list[dict[str, Any]] = [{} for _ in range(self.num_envs)]
        for place in np.flatnonzero(terminated | truncated):
            told[place]["terminal_observation"] = info["final_obs"][place]
            told[place]["TimeLimit.truncated"] = bool(truncated[place])
        return observation, rewards.astype(np.float32), terminated | truncated, told

    def close(self) -> None:
        """Nothing is open."""

    def env_method(self, method_name: str, *args: Any, indices: Any = None, **kwargs: Any) -> list[Any]:
        """`action_masks` of each is all that MaskablePPO asks for."""
        return list(getattr(self.env, method_name)(*args, **kwargs))

    def get_attr(self, attr_name: str, indices: Any = None) -> list[Any]:
        """The same of each, since they are of one kind."""
        return [getattr(self.env, attr_name)] * self.num_envs

    def set_attr(self, attr_name: str, value: Any, indices: Any = None) -> None:
        """Nothing can be set."""
        raise AttributeError(attr_name)

    def env_is_wrapped(self, wrapper_class: Any, indices: Any = None) -> list[bool]:
        """None is."""
        return [False] * self.num_envs


def returns(problem: str, seed: int, model: MaskablePPO | None) -> np.ndarray[Any, np.dtype[np.float64]]:
    """What an episode each of a policy returns, (EPISODES,); without one, actions that apply are drawn."""
    env, rng = opened(problem, EPISODES), np.random.default_rng(seed)
    observation, info = env.reset(seed=seed)
    totals, over = np.zeros(EPISODES), np.zeros(EPISODES, bool)
    while not over.all():
        masks = info["action_mask"]
        if model is None:
            actions = (rng.random(masks.shape) * (masks + 1e-9)).argmax(axis=1)
        else:
            actions, _ = model.predict(observation, action_masks=masks == 1, deterministic=True)
        observation, rewards, terminated, truncated, info = env.step(actions)
        totals += np.where(over, 0.0, rewards)
        over |= terminated | truncated
    return totals


class Curve(BaseCallback):
    """Values the policy every so many CPU seconds of training, and ends the training after the last."""

    def __init__(self, problem: str, seed: int, times: Sequence[float], keep: Path | None) -> None:
        super().__init__()
        self.problem, self.seed, self.times, self.keep = problem, seed, list(times), keep
        self.begun, self.aside = 0.0, 0.0

    def _on_training_start(self) -> None:
        self.begun = time.process_time()

    def _on_step(self) -> bool:
        trained = time.process_time() - self.begun - self.aside
        if trained < self.times[0]:
            return True
        del self.times[0]
        self.tell("MaskablePPO", trained, self.model)
        self.aside = time.process_time() - self.begun - trained
        return bool(self.times)

    def tell(self, policy: str, trained: float, model: Any) -> None:
        """A row: what the episodes of a policy return."""
        found = returns(self.problem, 10_000 + self.seed, model)
        row = {"problem": Path(self.problem).stem, "policy": policy, "seed": self.seed}
        row |= {"seconds": round(trained, 1), "steps": self.num_timesteps, "episodes": EPISODES}
        row |= {"return": round(float(found.mean()), 3), "sd": round(float(found.std()), 3)}
        print(json.dumps(row), flush=True)
        if self.keep:
            with self.keep.open("a", encoding="utf-8") as file:
                file.write(json.dumps(row) + "\n")


def main() -> None:
    """Train, and print a row for each half minute."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("problem", nargs="?", default=str(HERE / "forty_lentils.nid"))
    parser.add_argument("--minutes", type=float, default=5.0, help="of CPU time (%(default)s)")
    parser.add_argument("--every", type=float, default=30.0, help="seconds between two rows (%(default)s)")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--keep", type=Path, help="append the rows to this file, too")
    options = parser.parse_args()
    torch.set_num_threads(1)
    env = SideBySide(opened(options.problem, EPISODES))
    model = MaskablePPO(
        "MlpPolicy",
        env,
        seed=options.seed,
        n_steps=64,
        batch_size=2048,
        n_epochs=4,
        learning_rate=1e-3,
        ent_coef=0.01,
        gamma=0.995,
    )
    times = np.arange(options.every, 60 * options.minutes + 1e-9, options.every)
    curve = Curve(options.problem, options.seed, times.tolist(), options.keep)
    curve.init_callback(model)
    curve.tell("random", 0.0, None)
    model.learn(10**12, callback=curve)


if __name__ == "__main__":
    main()
