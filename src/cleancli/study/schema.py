"""What a study may say: each setting's kind of value, its default and what it means.

The checker reads by this table, editors complete and explain by it, and the tests hold docs/experiments.md
against it. Settings of a scene are those of scene/schema.py.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from types import MappingProxyType

from cleancli.language.checking.learned import LARGEST_M, MOST_FORGETTING
from cleancli.scene.kinds import Choice, Number, Whole
from cleancli.scene.robots import ARMS
from cleancli.scene.schema import KEYS as SCENE
from cleancli.scene.schema import NEEDED, SECTIONS, TOP, Key
from cleancli.study.kinds import Named, Text, option
from cleancli.study.row import MEASURES

STRATEGIES = ("plan-1", "plan-2", "plan-3", "plan-all", "determinized", "explore", "reactive", "wipe", "tsp")
"""Those of `execution.strategies`, which takes long to load: a test holds them equal, and what follows."""
USUAL_STRATEGIES = ("plan-2", "plan-1")
"""Where a study names none: for scenes, and for problems that are none."""
PLANNERS = ("prada+", "prada", "aprada", "exact", "uct", "sst", "likeliest", "all-outcomes")
ESTIMATORS = ("decreasing-m", "m", "fitted-m", "likelihood")
NOTHING = "none"
"""The estimator of who learns nothing."""
SIMULATORS = ("physics", "stand-in")
EXPECTED = ("less", "more", "equal")

MOST = 10**9
"""Of anything that is counted, as in `execution.setup`."""
MOST_RUNS = 10_000
"""And episodes of a series; chosen, as all that is to be done is held in memory."""

AXES: Mapping[str, Key] = MappingProxyType(
    {
        "domain": Key(Named("a domain"), None, "the rules to plan by; where none is named, the scene's own"),
        "scene": Key(Named("a scene or a problem"), NEEDED, "what is carried out: scenes and problems"),
        "strategy": Key(
            option(*STRATEGIES), None, "who decides what to do; where none is named, as in `execute`"
        ),
        "planner": Key(option(*PLANNERS), None, "what plans; where none is named, the strategy's own"),
        "samples": Key(Whole(1, MOST), 10_000, "action sequences to draw for each plan"),
        "objective": Key(option("reward", "time"), None, "what discounts later rewards"),
        "job": Key(option("container", "dustpan", "wipe", "zone"), None, "how dirt leaves the table"),
        "estimator": Key(
            option(NOTHING, *ESTIMATORS), NOTHING, "how counts and prior are combined while learning"
        ),
        "m": Key(Number(0, LARGEST_M, including=True), None, "what the prior weighs, in examples"),
        "match": Key(option("shared", "strict"), None, "what a transition of several outcomes counts for"),
        "forgetting": Key(
            Number(0, MOST_FORGETTING, including=True), None, "by which share older examples count for less"
        ),
        "known": Key(Whole(0, MOST), None, "how often a rule is seen before the arm stays in view after it"),
        "optimism": Key(option("prior", "rmax"), "prior", "what plans hope of rules that are not known"),
        "world": Key(Named("a domain"), None, "the rules by which the symbolic world acts, if others"),
        "simulator": Key(option(*SIMULATORS), "physics", "what stands for the table of a scene"),
    }
)
"""What a study may list several values of: each combination is a cell."""

OWN: Mapping[str, Key] = MappingProxyType(
    {
        "about": Key(Text(), "", "what the study is for, in words", '"..."'),
        "studies": Key(Named("a study"), None, "the studies that this one consists of"),
        "runs": Key(Whole(1, MOST_RUNS), 5, "how often each cell is carried out, with seeds of its own"),
        "episodes": Key(
            Whole(1, MOST_RUNS), 1, "episodes of a run, which go on from what those before learned"
        ),
        "seed": Key(Whole(0, 2**31 - 1), 1, "the seed of the first run"),
        "max_actions": Key(Whole(0, MOST), 60, "actions after which an episode is given up"),
        "max_seconds": Key(
            Number(0, MOST, including=True),
            1800.0,
            "seconds after which one is given up; one of a problem that is no scene only where this is said",
        ),
        "measure": Key(Choice(tuple(MEASURES)), "seconds", "what is shown"),
    }
)
"""What a study says once."""

COMPARED: Mapping[str, Key] = MappingProxyType(
    {
        "claim": Key(Whole(1, 9), None, "the number of the paper's claim that it tests"),
        "says": Key(Text(), "", "what is expected, in words", '"..."'),
        "measure": Key(
            Choice(tuple(MEASURES)), None, "what is compared; where none is named, what the study shows"
        ),
        "expect": Key(Choice(EXPECTED), "less", "what `first` is expected to be beside `second`"),
        "factor": Key(Number(0, 1000), 1.0, "times which `second` counts"),
        "limit": Key(
            Number(0, MOST, including=True), None, "what `first` is beside where there is no `second`"
        ),
        "margin": Key(Number(0, 1, including=True), 0.0, "the share of `second` up to which both are equal"),
    }
)
"""What a comparison says."""

OF_ROWS: Mapping[str, Key] = MappingProxyType(
    {
        "part": Key(Named("a part of this study"), None, "the part that rows are of"),
        "episode": Key(Whole(1, MOST_RUNS), None, "the numbers of episodes in their series"),
    }
)
"""What rows may be selected by, beside the axes."""

VARIED = tuple(name for name in SECTIONS if name not in ("grasp", "dirt"))
"""The sections of a scene that a study may say otherwise."""

SIDES = ("first", "second")


def keys_of(section: str) -> Mapping[str, Key]:
    """The settings of a section, by their keys."""
    match section:
        case "part":
            return AXES
        case "compare":
            return {**COMPARED, **AXES, **OF_ROWS}
        case "first" | "second":
            return {**AXES, **OF_ROWS}
        case "rag":  # a scene may define grasps of its own
            grasp = replace(SCENE["rag"]["grasp"], kind=Choice(), example="folded")
            return {**SCENE["rag"], "grasp": grasp}
        case "robot":  # a study simulates its robots
            drive = replace(SCENE["robot"]["drive"], kind=Choice(tuple(ARMS)))
            return {"drive": drive, "height_noise": SCENE["robot"]["height_noise"]}
        case _ if section in VARIED:
            return SCENE[section]
        case _ if section in (TOP, "quick"):
            return {**OWN, **AXES}
    return {}


INNER: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {
        TOP: ("part", "quick", "compare", *VARIED),
        "quick": VARIED,
        "part": VARIED,
        "compare": (*SIDES, *VARIED),
        "first": VARIED,
        "second": VARIED,
    }
)
"""The sections that a section may hold."""

ONE_VALUE = frozenset({*OWN, *COMPARED}) - {"studies"}
"""Settings that have one value; `measure` among them. All others may list several."""
