"""`cleancli/Symbolic-v0`: any domain and problem for Gymnasium, one episode or many side by side.

What an action does is drawn from the domain's rules, as in `cleancli simulate`; docs/gym.md says what each
array and number means.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Literal

import gymnasium
import numpy as np
from gymnasium import spaces
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space
from numpy.typing import NDArray

from cleancli.array_types import Bools, Floats, Ints
from cleancli.compiler.task import Task
from cleancli.environment import MOST_ACTIONS
from cleancli.environment.batch import Batch, Opened, fact_name, opened

Info = dict[str, Any]
Observed = Literal["array", "facts"]


class Symbolic(gymnasium.Env[Any, np.int64]):
    """A problem to be solved by one action a step.

    `problem` and `domain` are names of shipped files or paths; the domain is otherwise the problem's.
    `observation`: the state's values as an "array" or as a dictionary of "facts". `max_actions`: after so
    many the episode is truncated. Raises `Refused` for files with mistakes, ValueError for a problem in which
    there is nothing to do.
    """

    metadata = {"render_modes": ["ansi"], "render_fps": 4}  # noqa: RUF012 (as gymnasium declares it)

    def __init__(
        self,
        problem: str = "three_areas",
        domain: str | None = None,
        observation: Observed = "array",
        max_actions: int = MOST_ACTIONS,
        render_mode: str | None = None,
    ) -> None:
        if render_mode not in (None, "ansi"):
            raise ValueError(f'render_mode must be None or "ansi", not {render_mode!r}')
        found = _checked(problem, domain, observation, max_actions)
        self.task, self.observation, self.render_mode = found.task, observation, render_mode
        self.choices, self.facts = choices(self.task), facts(self.task)
        self.observation_space, self.action_space = _spaces(self.task, observation)
        self._batch = Batch(found, 1, max_actions)
        self._begun = False

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[Any, Info]:
        """Go back to the problem's facts. With a seed, what comes of the actions is drawn anew from there."""
        super().reset(seed=seed)
        if seed is not None or not self._begun:
            self._batch.seed({0: int(self.np_random.integers(2**63)) if seed is None else seed})
        self._begun = True
        self._batch.restart(np.ones(1, np.bool_))
        return self._observation(), self._info()

    def step(self, action: Any) -> tuple[Any, float, bool, bool, Info]:
        """Do one action. One that no rule covers now, which the mask forbids, changes nothing and costs what
        it costs. Raises ValueError for what is no action of the action space."""
        if not self._begun:
            raise gymnasium.error.ResetNeeded("call reset() first")
        if action not in self.action_space:
            raise ValueError(f"an action is a number from 0 to {len(self.choices) - 1}, not {action!r}")
        batch = self._batch
        batch.step(np.array([action], np.int32), np.zeros(1, np.bool_))
        ended = bool(batch.terminated[0]), bool(batch.truncated[0])
        return self._observation(), float(batch.rewards[0]), *ended, self._info()

    def action_masks(self) -> Bools:
        """Which actions a rule covers now, (A,): what sb3-contrib's MaskablePPO asks for."""
        return np.asarray(self._batch.masks[0] == 1)

    def render(self) -> str | None:
        """The facts that hold now, a line each; None without `render_mode`."""
        if self.render_mode is None:
            return None
        told = zip(self.facts, self.task.variables, self._batch.states[0].tolist(), strict=True)
        values = ((name, variable.values[value]) for name, variable, value in told)
        shown = (
            name if value is True else f"{name} = {value}" for name, value in values if value is not False
        )
        return "\n".join(sorted(shown))

    def _observation(self) -> Any:
        return _of_one(_observed(self.task, self.observation, self._batch.states), 0)

    def _info(self) -> Info:
        return {"action_mask": self._batch.masks[0].copy(), "is_success": bool(self._batch.succeeded[0])}


class SymbolicVector(VectorEnv[Any, Ints, Any]):
    """Many episodes of a problem at once, carried out together in compiled code: `gymnasium.make_vec` with
    `vectorization_mode="vector_entry_point"`. Each is, draw by draw, that of a `Symbolic` with its seed.

    By `autoreset_mode`, Gymnasium's `AutoresetMode`, an episode that has ended begins anew at the next step,
    whose action counts for nothing ("NextStep"), or at once ("SameStep"): then the observation is the new
    episode's, and `info["final_obs"]` and `info["final_info"]` have the last ones of those that
    `info["_final_obs"]` is true of. Other parameters and errors are those of `Symbolic`.
    """

    metadata = {"autoreset_mode": AutoresetMode.NEXT_STEP, "render_modes": []}  # noqa: RUF012 (as declared there)

    def __init__(
        self,
        num_envs: int = 1,
        problem: str = "three_areas",
        domain: str | None = None,
        observation: Observed = "array",
        max_actions: int = MOST_ACTIONS,
        render_mode: None = None,
        autoreset_mode: AutoresetMode | str = AutoresetMode.NEXT_STEP,
    ) -> None:
        if num_envs < 1:
            raise ValueError(f"num_envs must be at least 1, not {num_envs}")
        mode = AutoresetMode(autoreset_mode)
        if mode is AutoresetMode.DISABLED:
            raise ValueError('autoreset_mode must be "NextStep" or "SameStep"')
        found = _checked(problem, domain, observation, max_actions)
        self.task, self.observation, self.num_envs = found.task, observation, num_envs
        self.choices, self.facts = choices(self.task), facts(self.task)
        self.render_mode = render_mode
        self.metadata = self.metadata | {"autoreset_mode": mode}
        self._begins_at_once = mode is AutoresetMode.SAME_STEP
        self.single_observation_space, self.single_action_space = _spaces(self.task, observation)
        self.observation_space = batch_space(self.single_observation_space, num_envs)
        self.action_space = batch_space(self.single_action_space, num_envs)
        self._batch = Batch(found, num_envs, max_actions)
        self._all = np.ones(num_envs, np.bool_)
        self._ended = np.zeros(num_envs, np.bool_)
        self._begun = False

    def reset(
        self, *, seed: int | Sequence[int | None] | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Any, Info]:
        """Go back to the problem's facts in all episodes. A number seeds the first, and each of the others
        with one more; a list has a seed for each."""
        super().reset(seed=seed if isinstance(seed, int) else None)
        given = _each(seed, self.num_envs)
        if not self._begun:
            drawn = self.np_random.integers(2**63, size=self.num_envs).tolist()
            given = [other if one is None else one for one, other in zip(given, drawn, strict=True)]
        self._begun = True
        self._batch.seed({place: one for place, one in enumerate(given) if one is not None})
        self._ended[:] = False
        self._batch.restart(self._all)
        return self._observation(), self._info()

    def step(self, actions: Any) -> tuple[Any, Floats, Bools, Bools, Info]:
        """Do an action of each, as `Symbolic.step` does; (num_envs,) each. Raises ValueError for what is no
        action of the action space."""
        if not self._begun:
            raise gymnasium.error.ResetNeeded("call reset() first")
        chosen = np.asarray(actions)
        if chosen.shape != (self.num_envs,) or chosen.dtype.kind not in "iu":
            raise ValueError(f"there must be {self.num_envs} actions, each a number")
        if chosen.min() < 0 or chosen.max() >= len(self.choices):
            raise ValueError(f"an action is a number from 0 to {len(self.choices) - 1}")
        batch = self._batch
        batch.step(chosen.astype(np.int32), self._ended)
        over = batch.terminated | batch.truncated
        last = {}
        if self._begins_at_once:
            if over.any():
                last = self._last(over)
                batch.restart(over)
        else:
            self._ended = over
        came_to = batch.rewards.copy(), batch.terminated.copy(), batch.truncated.copy()
        return self._observation(), *came_to, self._info() | last

    def action_masks(self) -> Bools:
        """Which actions a rule covers now, (num_envs, A)."""
        return np.asarray(self._batch.masks == 1)

    def _observation(self) -> Any:
        return _observed(self.task, self.observation, self._batch.states)

    def _last(self, over: Bools) -> Info:
        """How the episodes that are over ended; as Gymnasium's own vectors tell it, an object an episode."""
        last: NDArray[np.object_] = np.full(self.num_envs, None, dtype=object)
        states = _observed(self.task, self.observation, self._batch.states)
        for place in np.flatnonzero(over):
            last[place] = _of_one(states, int(place))
        told = self._info() | {"_action_mask": over, "_is_success": over}
        return {"final_obs": last, "_final_obs": over, "final_info": told, "_final_info": over}

    def _info(self) -> Info:
        masks, succeeded = self._batch.masks.copy(), self._batch.succeeded.copy()
        both = {"action_mask": masks, "_action_mask": self._all}
        return both | {"is_success": succeeded, "_is_success": self._all}


def choices(task: Task) -> tuple[str, ...]:
    """What each action of the action space is: `push(a1)`."""
    return tuple(str(action) for action in task.actions)


def facts(task: Task) -> tuple[str, ...]:
    """What each number of the observation is of: `dirt(a1)`."""
    return tuple(map(fact_name, task.variables))


def _checked(problem: str, domain: str | None, observation: str, max_actions: int) -> Opened:
    if observation not in ("array", "facts"):
        raise ValueError(f'observation must be "array" or "facts", not {observation!r}')
    if max_actions < 1:
        raise ValueError(f"max_actions must be at least 1, not {max_actions}")
    return opened(problem, domain)


def _spaces(task: Task, observation: Observed) -> tuple[spaces.Space[Any], spaces.Discrete]:
    actions = spaces.Discrete(len(task.actions))
    if observation == "array":
        return spaces.MultiDiscrete([len(variable.values) for variable in task.variables]), actions
    numbers: dict[str, spaces.Space[Any]] = {
        fact_name(variable): spaces.Discrete(len(variable.values)) for variable in task.variables
    }
    return spaces.Dict(numbers), actions


def _observed(task: Task, observation: Observed, states: Ints) -> Any:
    """What the spaces hold, of many states: (N, V), or a dictionary of (N,)."""
    values = states.astype(np.int64)
    if observation == "array":
        return values
    return {name: values[:, place] for place, name in enumerate(facts(task))}


def _of_one(observations: Any, place: int) -> Any:
    if isinstance(observations, dict):
        return {name: values[place] for name, values in observations.items()}
    return observations[place]


def _each(seed: int | Sequence[int | None] | None, number: int) -> list[int | None]:
    """A seed for each episode; None where it is to go on with the draws that it had."""
    if seed is None:
        return [None] * number
    if isinstance(seed, int):
        return [seed + place for place in range(number)]
    if len(seed) != number:
        raise ValueError(f"there must be {number} seeds, one for each episode, not {len(seed)}")
    return list(seed)
