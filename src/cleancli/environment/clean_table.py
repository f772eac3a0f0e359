"""`cleancli/CleanTable-v0`: the table, robot and perception of `cleancli execute`, for other people's agents.

An agent sees what perception reports, never where the dirt truly is.
"""

from __future__ import annotations

from typing import Any, Literal

import gymnasium
import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from cleancli.compiler.ground import ground
from cleancli.compiler.task import holds
from cleancli.environment.observation import Arrays, observation_space, observed
from cleancli.environment.pushes import ends
from cleancli.environment.slots import Slots, choices, filled
from cleancli.execution.events import Situation
from cleancli.execution.loop import FRAMES_PER_LOOK, problem_of, within_reach
from cleancli.execution.seeds import Purpose, derived
from cleancli.language.load import load_domain, read_source
from cleancli.language.model import Domain
from cleancli.motion.actions import path_along, tool_path
from cleancli.motion.path import ToolPath
from cleancli.perception.area import Area
from cleancli.perception.perceive import perceive
from cleancli.perception.symbols import symbolize
from cleancli.perception.tracking import Stroke, track
from cleancli.scene.check import load_scene
from cleancli.scene.model import Scene
from cleancli.shipped import find
from cleancli.world.robot import Status
from cleancli.world.table import PybulletTable

Info = dict[str, Any]
IMPOSSIBLE = "no area stands in that slot, or no rule covers the action"


class CleanTable(gymnasium.Env[Arrays, Any]):
    """A dirty table to be cleaned by one action a step; docs/gym.md says what each array and number means.

    `scene` and `domain` are names of shipped files or paths; the domain is otherwise the scene's. `actions`:
    "symbolic" (an index of `choices`, see `info["action_mask"]`) or "physical" (a push as four numbers in
    [-1, 1]). `slots`: how many areas are told at once. `image`: also the camera's picture. `truth`: tell
    in `info["truth"]` where the particles are, for reports. Raises `Refused` for files with mistakes.
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
        render_mode: str | None = None,
    ) -> None:
        if actions not in ("symbolic", "physical"):
            raise ValueError(f'actions must be "symbolic" or "physical", not {actions!r}')
        if slots < 1:
            raise ValueError(f"slots must be at least 1, not {slots}")
        if render_mode not in (None, "rgb_array"):
            raise ValueError(f'render_mode must be None or "rgb_array", not {render_mode!r}')
        self.scene, self.domain = _opened(scene, domain)
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
        self._table: PybulletTable | None = None

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[Arrays, Info]:
        """Lay the dirt anew and look. With a seed, the table is that of `cleancli execute --seed`; without
        one, each episode draws its own, which `info["seed"]` tells."""
        super().reset(seed=seed)
        chosen = int(self.np_random.integers(2**31)) if seed is None else seed
        self.close()
        self._table = PybulletTable(self.scene, derived(chosen, Purpose.WORLD))
        self._rng = np.random.default_rng(derived(chosen, Purpose.PERCEPTION))
        self._areas: tuple[Area, ...] = ()
        self._slots, self._named = self._empty, 0
        self._withdraw()
        self._look(None)
        return self._observation(), self._info(0.0, "") | {"seed": chosen}

    def step(self, action: Any) -> tuple[Arrays, float, bool, bool, Info]:
        """Carry out one action, withdraw the tool and look.

        The reward is by how much fewer areas are seen than before (eq. 2; negative, if they have become
        more). The episode is over when two looks in a row show none. An action that the mask forbids, or that
        the robot fails at, is no error: `info["failure"]` says why. Raises ValueError for what is no action
        of the action space; a push may exceed it, and is cut off.
        """
        table = self._running()
        before, started = len(self._areas), table.clock
        path, pushed = self._meant(action)
        failure = IMPOSSIBLE
        if path is not None:
            failure = self._carry_out(path)
            on_surface = tuple((w.x, w.y) for w in path.waypoints if w.z <= 0)
            self._look(Stroke(pushed, on_surface, self.scene.rag.width / 2))
        if not self._areas:
            self._look(None)
        reward = float(before - len(self._areas))
        return self._observation(), reward, not self._areas, False, self._info(started, failure)

    def render(self) -> NDArray[np.uint8] | None:
        """The table as an onlooker sees it now, (480, 640, 3) RGB; None without `render_mode`."""
        return None if self.render_mode is None else self._running().picture()

    def close(self) -> None:
        """Free the simulated table; `reset` makes another one."""
        if self._table is not None:
            self._table.close()
            self._table = None

    def _running(self) -> PybulletTable:
        if self._table is None:
            raise gymnasium.error.ResetNeeded("call reset() first")
        return self._table

    def _meant(self, action: Any) -> tuple[ToolPath | None, tuple[str, ...]]:
        """The tool's path, and which areas it is to push; no path for what the mask forbids."""
        if not self.choices:
            return path_along(ends(action, self.scene), self.scene), ()
        if action not in self.action_space:
            raise ValueError(f"an action is a number from 0 to {len(self.choices) - 1}, not {action!r}")
        name, places = self.choices[int(action)]
        if not self._mask()[int(action)]:
            return None, ()
        ellipses = {area.name: area.ellipse for area in self._areas}
        names = tuple(str(self._slots[place]) for place in places)
        return tool_path(name, tuple(ellipses[each] for each in names), self.scene), names

    def _carry_out(self, path: ToolPath) -> str:
        """Returns why the robot failed, or nothing; either way the tool is out of the camera's view then."""
        table = self._running()
        table.start(path)
        while (status := table.poll()) is Status.RUNNING:
            pass
        failure = table.failure if status is Status.FAILED else ""
        if failure:
            table.stop()
        self._withdraw()
        return failure

    def _withdraw(self) -> None:
        table = self._running()
        table.withdraw()
        while table.poll() is Status.RUNNING:
            pass

    def _look(self, stroke: Stroke | None) -> None:
        """See the table, name its areas as what has become of those before, and give them slots."""
        frames = [self._running().observe() for _ in range(FRAMES_PER_LOOK)]
        seen = perceive(frames, self.scene, self._rng).areas
        self._areas = track(self._areas, seen, stroke, self._named + 1)
        self._named = max([self._named, *(int(area.name[1:]) for area in self._areas)])
        self._slots = filled(self._slots, self._areas)
        told = [area for area in self._areas if area.name in self._slots]
        objects, state = symbolize(told, self.scene, self.domain)
        self._situation = Situation(frames[-1], self._areas, objects, state)

    def _observation(self) -> Arrays:
        space = self.observation_space
        assert isinstance(space, spaces.Dict)
        situation = self._situation
        arrays = observed(self.domain, self._slots, situation.areas, situation.state, space)
        if self._image:
            arrays["image"] = situation.frame.colour.copy()
        return arrays

    def _info(self, started: float, failure: str) -> Info:
        """What is no observation: robot time, names, and which actions make sense now."""
        table = self._running()
        info: Info = {
            "seconds": table.clock - started,
            "clock": table.clock,
            "failure": failure,
            "areas": [area.name for area in self._areas],
            "slots": list(self._slots),
        }
        if self.choices:
            info["action_mask"] = self._mask()
        if self._tells_truth:
            truth = table.truth()
            info["truth"] = {
                "particles": truth.total,
                "on_table": truth.on_table,
                "in_container": truth.in_container,
                "in_dustpan": truth.in_dustpan,
                "on_floor": truth.on_floor,
                "ink_left": truth.ink_left,
            }
        return info

    def _mask(self) -> NDArray[np.int8]:
        """1 for each choice that a rule of the domain covers now, as the planners see it."""
        task = ground(self.domain, problem_of(self.scene, self.domain, self._situation))
        covered = {task.actions[r.action] for r in task.rules if holds(r.condition, task.initial)}
        possible = {(action.name, action.objects) for action in covered}
        asked = ((name, tuple(self._slots[place] for place in places)) for name, places in self.choices)
        return np.array([call in possible for call in asked], np.int8)


def _opened(scene_name: str, domain_name: str | None) -> tuple[Scene, Domain]:
    """The scene, and what its robot can do of the domain: the one named, or else the scene's own, which is
    sought beside the scene before it is sought among the shipped ones."""
    path = find(scene_name, "problems")
    scene = load_scene(read_source(path))
    beside = path.parent / f"{scene.domain}.nid"
    named = domain_name or (str(beside) if beside.is_file() else scene.domain)
    domain = within_reach(load_domain(read_source(find(named, "domains"))), scene.robot)
    symbolize((), scene, domain)  # refuses what perception can't tell
    return scene, domain
