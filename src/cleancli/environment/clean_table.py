"""`cleancli/CleanTable-v0`: the table, robot and perception of `cleancli execute`, for other people's agents.

An agent sees what perception reports, never where the dirt truly is.
"""

from __future__ import annotations

from typing import Any, Literal

import gymnasium
import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from cleancli.array_types import Bools, Image
from cleancli.compiler.ground import ground
from cleancli.compiler.task import holds
from cleancli.environment.observation import Arrays, observation_space, observed
from cleancli.environment.pushes import ends
from cleancli.environment.slots import Slots, choices, filled
from cleancli.execution.episode_state import Move, Situation
from cleancli.execution.session import Session, stand_in_session, table_session
from cleancli.execution.setup import EpisodeOptions, usual_job, within_reach
from cleancli.execution.workcell import LookResult, Motion, Motions
from cleancli.language.find import find, find_beside
from cleancli.language.load import load_domain, read_source
from cleancli.language.model import Domain
from cleancli.motion.actions import path_along
from cleancli.perception.symbols import symbolize
from cleancli.perception.tracking import Stroke
from cleancli.scene.check import load_scene
from cleancli.scene.model import Scene
from cleancli.world.kinematic import refuse_without_stand_in

Info = dict[str, Any]
IMPOSSIBLE = "no area stands in that slot, or no rule covers the action"


class CleanTable(gymnasium.Env[Arrays, Any]):
    """A dirty table to be cleaned by one action a step; docs/gym.md says what each array and number means.

    `scene` and `domain` are names of shipped files or paths; the domain is otherwise the scene's. `actions`:
    "symbolic" (an index of `choices`, see `info["action_mask"]`) or "physical" (a push as four numbers in
    [-1, 1]). `slots`: how many areas are told at once. `image`: also the camera's picture. `truth`: tell
    in `info["truth"]` where the particles are, for reports. `simulator`: "physics", or the fast "stand_in"
    without forces and pictures. Raises `Refused` for files with mistakes, ValueError for what there is not.
    """

    metadata = {"render_modes": ["rgb_array"], "render_fps": 2}  # noqa: RUF012 (as gymnasium declares it)

    def __init__(
        self,
        scene: str = "two_groups",
        domain: str | None = None,
        actions: Literal["symbolic", "physical"] = "symbolic",
        slots: int = 10,
        image: bool = False,
        truth: bool = False,
        simulator: Literal["physics", "stand_in"] = "physics",
        render_mode: str | None = None,
    ) -> None:
        if actions not in ("symbolic", "physical"):
            raise ValueError(f'actions must be "symbolic" or "physical", not {actions!r}')
        if slots < 1:
            raise ValueError(f"slots must be at least 1, not {slots}")
        if render_mode not in (None, "rgb_array"):
            raise ValueError(f'render_mode must be None or "rgb_array", not {render_mode!r}')
        if simulator not in ("physics", "stand_in"):
            raise ValueError(f'simulator must be "physics" or "stand_in", not {simulator!r}')
        if simulator == "stand_in" and (image or render_mode):
            raise ValueError("the stand-in has no pictures: leave out `image` and `render_mode`")
        self.scene, self.domain = _opened(scene, domain)
        if simulator == "stand_in":
            refuse_without_stand_in(self.scene)
        self._opens = table_session if simulator == "physics" else stand_in_session
        self.choices = choices(self.domain, slots) if actions == "symbolic" else ()
        self.render_mode = render_mode
        self.action_space = (
            spaces.Discrete(len(self.choices))
            if actions == "symbolic"
            else spaces.Box(-1.0, 1.0, (4,), np.float32)
        )
        self.observation_space = observation_space(self.domain, self.scene, slots, image)
        self._image, self._tells_truth = image, truth
        self._empty: Slots = (None,) * slots
        self._session: Session | None = None

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[Arrays, Info]:
        """Lay the dirt anew and look. With a seed, the table is that of `cleancli execute --seed`; without
        one, each episode draws its own, which `info["seed"]` tells."""
        super().reset(seed=seed)
        chosen = int(self.np_random.integers(2**31)) if seed is None else seed
        self.close()
        self._session = self._opens(self.domain, self.scene, EpisodeOptions(seed=chosen))
        _done(self._session.cell.withdraw())
        self._slots = self._empty
        self._looks, self._sight = 0, self._session.cell.look(None, None, 0, 0)
        self._tell()
        return self._observation(), self._info(0.0, "", False) | {"seed": chosen}

    def step(self, action: Any) -> tuple[Arrays, float, bool, bool, Info]:
        """Carry out one action, withdraw the tool and look.

        The reward is by how much fewer areas are seen than before (eq. 2; negative, if they have become
        more). The episode is over when two looks in a row show none. An action that the mask forbids, or that
        the robot fails at, is no error: `info["failure"]` says why. Raises ValueError for what is no action
        of the action space; a push may exceed it, and is cut off.
        """
        cell = self._running().cell
        before, started = self._sight.situation, cell.clock
        move, failure = self._meant(action), IMPOSSIBLE
        if move is not None:
            motions = _done(cell.carry_out(1, move, cell.path(move, before)))
            failure = motions.failure
            _done(cell.withdraw())
            self._look(motions.stroke)
        if not self._sight.situation.areas:
            self._look(None)
        after = self._sight.situation
        reward = float(len(before.areas) - len(after.areas))
        is_clean = not after.areas
        return self._observation(), reward, is_clean, False, self._info(started, failure, is_clean)

    def action_masks(self) -> Bools:
        """Which of `choices` a rule covers now, (A,): what sb3-contrib's MaskablePPO asks for. Raises
        ValueError where actions are physical: then none is forbidden."""
        if not self.choices:
            raise ValueError("physical actions have no mask: none is forbidden")
        self._running()
        return np.asarray(self._mask() == 1)

    def render(self) -> Image | None:
        """The table as an onlooker sees it now, (480, 640, 3) RGB; None without `render_mode`."""
        picture = self._running().picture
        return None if self.render_mode is None or picture is None else picture(640, 480)

    def close(self) -> None:
        """Free the simulated table; `reset` makes another one."""
        if self._session is not None:
            self._session.close()
            self._session = None

    def _running(self) -> Session:
        if self._session is None:
            raise gymnasium.error.ResetNeeded("call reset() first")
        return self._session

    def _meant(self, action: Any) -> Move | None:
        """The move that is asked for; None for what the mask forbids."""
        if not self.choices:
            return Move("push", (), path_along(ends(action, self.scene), self.scene))
        if action not in self.action_space:
            raise ValueError(f"an action is a number from 0 to {len(self.choices) - 1}, not {action!r}")
        name, places = self.choices[int(action)]
        if not self._mask()[int(action)]:
            return None
        return Move(name, tuple(str(self._slots[place]) for place in places))

    def _look(self, stroke: Stroke | None) -> None:
        """See the table; areas are what has become of those before."""
        self._looks += 1
        last = self._sight
        self._sight = self._running().cell.look(last.situation, stroke, self._looks, last.named)
        self._tell()

    def _tell(self) -> None:
        """Give slots to the areas seen; the agent is told of those that have one."""
        seen = self._sight.situation.areas
        self._slots = filled(self._slots, seen)
        areas = tuple(area for area in seen if area.name in self._slots)
        self._told = Situation(areas, *symbolize(areas, self.scene, self.domain))

    def _observation(self) -> Arrays:
        space = self.observation_space
        assert isinstance(space, spaces.Dict)
        told = self._told
        arrays = observed(self.domain, self._slots, told.areas, told.state, space)
        if self._image:
            arrays["image"] = _colour(self._sight).copy()
        return arrays

    def _info(self, started: float, failure: str, is_clean: bool) -> Info:
        """What is no observation: robot time, names, and which actions make sense now."""
        session = self._running()
        info: Info = {
            "seconds": session.cell.clock - started,
            "clock": session.cell.clock,
            "failure": failure,
            "is_success": is_clean,
            "areas": [area.name for area in self._sight.situation.areas],
            "slots": list(self._slots),
        }
        if self.choices:
            info["action_mask"] = self._mask()
        if self._tells_truth:
            info["truth"] = dict(session.truth())
        return info

    def _mask(self) -> NDArray[np.int8]:
        """1 for each choice that a rule of the domain covers now, as the planners see it."""
        task = ground(self.domain, self._running().cell.problem(self._told))
        covered = {task.actions[r.action] for r in task.rules if holds(r.condition, task.initial)}
        possible = {(action.name, action.objects) for action in covered}
        asked = ((name, tuple(self._slots[place] for place in places)) for name, places in self.choices)
        return np.array([call in possible for call in asked], np.int8)


def _opened(scene_name: str, domain_name: str | None) -> tuple[Scene, Domain]:
    """The scene, and what its robot can do of the domain: the one named, or else the scene's own, which is
    sought beside the scene before it is sought among the shipped ones."""
    path = find(scene_name, "problems")
    scene = load_scene(read_source(path))
    rules = find(domain_name, "domains") if domain_name else find_beside(path, scene.domain, "domains")
    domain = load_domain(read_source(rules))
    symbolize((), scene, domain)  # refuses what perception can't tell
    return scene, within_reach(domain, scene.arms, usual_job(domain, scene.arms))


def _done(motion: Motion) -> Motions:
    """How a motion went, at its end."""
    while True:
        try:
            next(motion)
        except StopIteration as end:
            went: Motions = end.value
            return went


def _colour(sight: LookResult) -> Image:
    assert sight.frame is not None, "a table is looked at with a camera"
    return sight.frame.colour
