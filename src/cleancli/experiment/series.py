"""From a study to its episodes: cells, the texts of their files, and each run of a cell as a series."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

from cleancli.api.inputs import opened_domain
from cleancli.api.run_inputs import refuse_impossible
from cleancli.execution.setup import usual_strategy
from cleancli.execution.strategies import STRATEGIES
from cleancli.experiment.episode import Axes, Episode, Texts, inputs_for, versions_here
from cleancli.language.diagnostics.diagnostic import Diagnostic, Source
from cleancli.language.diagnostics.refused import Refused
from cleancli.language.find import find
from cleancli.language.load import domain_named, kind_of, read_source
from cleancli.language.syntax import SettingValue
from cleancli.resources import shipped_names
from cleancli.scene.calibration import as_text
from cleancli.scene.model import Scene
from cleancli.scene.robots import REMOTE
from cleancli.study.check import load_study
from cleancli.study.model import Selection, Study, Value
from cleancli.study.overrides import varied
from cleancli.study.row import MEASURES, SYMBOLIC
from cleancli.study.schema import AXES, NOTHING
from cleancli.world.kinematic import refuse_without_stand_in

_LEARNING = ("m", "match", "forgetting")

_KINDS = {"domains": ("domain",), "problems": ("problem", "scene"), "studies": ("study",)}
"""What files of each folder are."""

Series = tuple[Episode, ...]
"""Episodes of which each goes on from what those before it have learned."""

Block = tuple[Series, ...]
"""One run of every cell of a study, with seeds that all cells share."""


@dataclass(frozen=True, slots=True)
class Cell:
    """A combination of values of all axes, with the texts that it needs."""

    part: str
    axes: Axes
    texts: Texts


@dataclass(frozen=True)
class OpenedStudy:
    """A study with its text, which names files beside it, and its cells."""

    study: Study
    source: Source
    cells: tuple[Cell, ...]

    @cached_property
    def blocks(self) -> tuple[Block, ...]:
        """All its episodes, run by run."""
        return tuple(
            tuple(_series(self.study, cell, run) for cell in self.cells)
            for run in range(1, self.study.runs + 1)
        )


def open_studies(
    source: Source, quick: bool = False, runs: int | None = None, seed: int | None = None
) -> tuple[OpenedStudy, ...]:
    """The study of a text, then those that it consists of, each with its cells. `runs` and `seed` in place of
    its own; `quick`: made small. Raises Refused with the mistakes of the first study that has any."""
    study = load_study(source)
    chosen = study.quick if quick and study.quick is not None else study
    chosen = replace(
        chosen, runs=chosen.runs if runs is None else runs, seed=chosen.seed if seed is None else seed
    )
    own = (_opened(chosen, source),) if chosen.parts else ()
    inner = (_inner(name, study, source) for name in study.studies)
    return (*own, *(each for text in inner for each in open_studies(text, quick, runs, seed)))


def _opened(study: Study, source: Source) -> OpenedStudy:
    cells = tuple(_cells(study, source))
    _refuse_measures(study, cells, source)
    return OpenedStudy(study, source, cells)


def _inner(name: str, study: Study, source: Source) -> Source:
    """The text of a study that another consists of. Raises Refused where it consists of others itself."""
    with _located(source, study.written.get("studies", {}).get(name)):
        found = read_source(_path(name, source, "studies"))
        if load_study(found).studies:
            raise Refused([Diagnostic("E523", f"the study `{name}` consists of others itself", None)])
    return found


def _path(name: str, source: Source, kind: str) -> Path:
    """A file beside the study, or else a shipped one; one of another kind does not hide that, as the study
    itself may have the name of its scene. Raises Refused (E001)."""
    folder = Path(source.path).parent
    beside = [path for path in (folder / name, folder / f"{name}.nid") if path.is_file()]
    for path in beside:
        if name not in shipped_names(kind) or kind_of(read_source(path)) in _KINDS[kind]:
            return path
    return find(name, kind, folder=folder)


@contextmanager
def _located(source: Source, node: SettingValue | None) -> Iterator[None]:
    """Show mistakes that have no place at the place in the study that they come from."""
    try:
        yield
    except Refused as refused:
        span = None if node is None else node.span
        found = [replace(each, span=each.span or span) for each in refused.diagnostics]
        raise Refused(found, (*refused.sources, source)) from None


# ---- cells


def _cells(study: Study, source: Source) -> Iterator[Cell]:
    """All cells of a study, each once. Raises Refused for one that cannot be carried out."""
    files = _Files(study, source)
    found = set()
    for part in study.parts:
        for values in itertools.product(*part.axes.values()):
            cell = files.cell(part.name, dict(zip(part.axes, values, strict=True)))
            mark = part.name, tuple(cell.axes.items())
            if mark not in found:
                found.add(mark)
                _refuse_impossible(study, cell, source)
                yield cell


class _Files:
    """The texts that a study's cells name, each read and checked once."""

    def __init__(self, study: Study, source: Source) -> None:
        self._study, self._source = study, source
        self._domains: dict[str, tuple[Source, ...]] = {}
        self._given: dict[tuple[tuple[str, Value], ...], tuple[Scene | None, Source]] = {}

    def cell(self, part: str, axes: dict[str, Value]) -> Cell:
        """The cell of these values, with those that make no difference to it left out."""
        scene, given = self._scene(axes)
        named = axes.get("domain") or (domain_named(given).text if scene is None else scene.domain)
        with _located(self._source, self._node("domain", named) or self._node("scene", axes["scene"])):
            domain = self._domain(str(named))
        calibration = None
        if scene is not None and scene.calibration is not None:
            calibration = Source(scene.calibration.path, as_text(scene.calibration))
        world = axes.get("world")
        with _located(self._source, self._node("world", world)):
            acting = () if world is None else self._domain(str(world))
        texts = Texts(domain, given, calibration, acting)
        return Cell(part, _without_idle({**axes, "domain": named}, scene is not None), texts)

    def _scene(self, axes: Axes) -> tuple[Scene | None, Source]:
        """The scene or problem, varied as the cell says."""
        varying = {axis: value for axis, value in axes.items() if "." in axis}
        mark = (("scene", axes["scene"]), *varying.items())
        if mark not in self._given:
            self._given[mark] = self._varied(str(axes["scene"]), varying)
        return self._given[mark]

    def _varied(self, name: str, varying: Axes) -> tuple[Scene | None, Source]:
        node = self._node("scene", name)
        with _located(self._source, node):
            given = read_source(_path(name, self._source, "problems"))
            if kind_of(given) == "scene":
                settings = {axis: self._node(axis, value) for axis, value in varying.items()}
                return varied(given, {a: n for a, n in settings.items() if n is not None}, self._source)
            if varying:
                message = f"`{name}` is no scene, and has no `{next(iter(varying))}`"
                raise Refused([Diagnostic("E523", message, None)])
        return None, given

    def _domain(self, name: str) -> tuple[Source, ...]:
        if name not in self._domains:
            text = read_source(_path(name, self._source, "domains"))
            self._domains[name] = opened_domain(text, include_outside=False).sources
        return self._domains[name]

    def _node(self, axis: str, value: Value | None) -> SettingValue | None:
        return None if value is None else self._study.written.get(axis, {}).get(value)


def _without_idle(axes: Axes, is_scene: bool) -> Axes:
    """The values of a cell that make a difference, with the usual ones of what is always told."""
    strategy = str(axes.get("strategy") or usual_strategy(is_scene))
    usual = STRATEGIES[strategy].planner
    estimator = axes.get("estimator", NOTHING)
    idle = {"planner", "objective", "samples", "optimism"} if usual is None else set()
    idle |= {"known", "optimism", *_LEARNING} if estimator == NOTHING else set()
    simulator = axes.get("simulator", AXES["simulator"].default) if is_scene else SYMBOLIC
    told: Axes = {
        "domain": axes["domain"],
        "scene": axes["scene"],
        "strategy": strategy,
        "estimator": estimator,
        "simulator": simulator,
    }
    return {**told, **{axis: v for axis, v in axes.items() if axis not in told and axis not in idle}}


def _refuse_impossible(study: Study, cell: Cell, source: Source) -> None:
    """E523 for a cell whose values do not go together, and what inputs are refused for."""
    episode = _series(study, cell, 1)[0]
    node = study.written.get("scene", {}).get(cell.axes["scene"])
    with _located(source, node):
        try:
            inputs = inputs_for(episode)
            refuse_impossible(inputs)
            if isinstance(inputs.given, Scene) and inputs.given.robot == REMOTE:
                raise ValueError("a study simulates its tables, and the robot of this one is elsewhere")
            if cell.axes["simulator"] == "stand-in" and isinstance(inputs.given, Scene):
                refuse_without_stand_in(inputs.given)
        except ValueError as error:
            told = ", ".join(f"{axis} {cell.axes[axis]}" for axis in ("scene", "strategy", "simulator"))
            message = f"a cell cannot be carried out ({told}): {error}"
            raise Refused([Diagnostic("E523", message, None)]) from None


def _refuse_measures(study: Study, cells: Sequence[Cell], source: Source) -> None:
    """E523 for a measure that would be 0 throughout: of tables alone, and asked for of problems that are no
    scenes, or the other way round."""
    written = study.written.get("measure", {}).get(study.measure)
    asked: list[tuple[str, SettingValue | None, list[tuple[Selection, ...]]]] = [
        (study.measure, written, [()])
    ]
    for each in study.comparisons:
        sides = [each.first] if each.limit is not None else [each.first, each.second]
        asked.append((each.measure, each.node or written, [(each.where, side) for side in sides]))
    for measure, node, meant in asked:
        told = MEASURES[measure]
        for cell in (cell for cell in cells if any(_is_of(cell, each) for each in meant)):
            symbolic, name = cell.axes["simulator"] == SYMBOLIC, cell.axes["scene"]
            if told.of_tables and symbolic:
                message = f"`{measure}` is told of tables alone, and `{name}` is a problem without one"
                told_here = [other for other, each in MEASURES.items() if not each.of_tables]
            elif told.of_problems and not symbolic:
                message = f"`{measure}` is told of problems alone, and `{name}` is a table"
                told_here = [other for other, each in MEASURES.items() if not each.of_problems]
            else:
                continue
            where, others = "problems" if symbolic else "tables", ", ".join(f"`{o}`" for o in told_here)
            help = f"of {where} are told {others}"
            with _located(source, node):
                raise Refused([Diagnostic("E523", message, None, help=help)])


def _is_of(cell: Cell, selections: Iterable[Selection]) -> bool:
    """Whether all selections mean rows of a cell, whichever their episodes."""
    own = {"part": cell.part, **cell.axes}
    return all(
        axis == "episode" or own.get(axis) in values
        for selection in selections
        for axis, values in selection.items()
    )


def _series(study: Study, cell: Cell, run: int) -> Series:
    """A run of a cell: seeds follow one another, as those of `cleancli execute --episodes` do."""
    found: list[Episode] = []
    first = study.seed + (run - 1) * study.episodes
    limits = study.symbolic_limits if cell.axes["simulator"] == SYMBOLIC else study.limits
    for number in range(1, study.episodes + 1):
        before = found[-1].key if found else ""
        found.append(
            Episode(
                study.name,
                cell.part,
                cell.axes,
                run,
                number,
                first + number - 1,
                limits,
                cell.texts,
                dict(versions_here()),
                before,
            )
        )
    return tuple(found)
