"""From syntax to the checked study: its axes, parts and comparisons, and whether these fit one another.

What its scenes and domains hold is not looked at here, but where an episode is made ready (`experiment`).
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from cleancli.language.diagnostics.diagnostic import Source
from cleancli.language.diagnostics.refused import Refused
from cleancli.language.diagnostics.sink import Findings
from cleancli.language.load import parse_as
from cleancli.language.syntax import Entry, Listed, Section, SettingValue, StudyNode
from cleancli.scene.kinds import Report
from cleancli.scene.schema import TOP
from cleancli.study.kinds import axis_value
from cleancli.study.model import Comparison, Limits, Part, Selection, Study, Value
from cleancli.study.schema import (
    AXES,
    COMPARED,
    INNER,
    ONE_VALUE,
    OWN,
    SIDES,
    USUAL_STRATEGIES,
    VARIED,
    keys_of,
)


@dataclass(frozen=True, slots=True)
class _Stated:
    """The values of a setting, and how they are written."""

    values: tuple[Any, ...]
    nodes: tuple[SettingValue, ...] = ()


_Settings = Mapping[str, _Stated]

_AXIS = "axis"
"""The kind of name by which an axis is noted of which a value could not be read."""

_QUICK: _Settings = {"runs": _Stated((1,)), "episodes": _Stated((1,)), "simulator": _Stated(("stand-in",))}
"""What a quick study has where it says nothing else."""


def load_study(source: Source) -> Study:
    """The checked study; raises Refused with every mistake."""
    root, findings = parse_as(source, "study")
    if not isinstance(root, StudyNode):
        raise Refused(findings.sorted, [source])
    study = check_study(root, findings)
    findings.refuse_errors()
    return study


def check_study(node: StudyNode, findings: Findings) -> Study:
    """The model of a study; it may only be used if `findings` holds no error."""
    top, sections = _read(node.entries, TOP, findings)
    quick: _Settings = {}
    parts: list[tuple[str, _Settings]] = []
    for section in sections:
        if section.name.text == "quick":
            quick, _ = _read(section.entries, "quick", findings)
        elif section.name.text == "part":
            stated, _ = _read(section.entries, "part", findings)
            parts.append((_title(section), {**_axes(top), **stated}))
    if not parts and ("scene" in top or "studies" not in top):
        parts = [("", _axes(top))]
    _refuse_without_scene(node, parts, findings)
    measure = top["measure"].values[0] if "measure" in top else OWN["measure"].default
    comparisons = tuple(
        _comparison(section, parts, measure, findings)
        for section in sections
        if section.name.text == "compare"
    )
    whole = _study(node.name.text, top, parts, comparisons)
    small = [(name, {**axes, **_axes(_QUICK), **_axes(quick)}) for name, axes in parts]
    return replace(whole, quick=_study(node.name.text, {**top, **_QUICK, **quick}, small, comparisons))


def _study(
    name: str, top: _Settings, parts: Sequence[tuple[str, _Settings]], comparisons: tuple[Comparison, ...]
) -> Study:
    own = {key: stated.values for key, stated in top.items() if key in OWN}
    once = {key: own.get(key, (known.default,))[0] for key, known in OWN.items()}
    return Study(
        name=name,
        about=once["about"],
        parts=tuple(
            Part(title, {axis: stated.values for axis, stated in axes.items()}) for title, axes in parts
        ),
        comparisons=comparisons,
        measure=once["measure"],
        runs=once["runs"],
        episodes=once["episodes"],
        seed=once["seed"],
        limits=Limits(once["max_actions"], once["max_seconds"]),
        symbolic_limits=Limits(once["max_actions"], own.get("max_seconds", (math.inf,))[0]),
        studies=own.get("studies", ()),
        written=_written([top, *(axes for _, axes in parts)]),
    )


def _written(stated: Iterable[_Settings]) -> Mapping[str, Mapping[Value, SettingValue]]:
    found: dict[str, dict[Value, SettingValue]] = {}
    for settings in stated:
        for key, each in settings.items():
            found.setdefault(key, {}).update(zip(each.values, each.nodes, strict=False))
    return found


def _axes(settings: _Settings) -> dict[str, _Stated]:
    """Those that have a value in each cell: all but what a study says once."""
    return {key: stated for key, stated in settings.items() if key not in OWN}


def _refuse_without_scene(
    node: StudyNode, parts: Sequence[tuple[str, _Settings]], findings: Findings
) -> None:
    if "scene" in findings.broken or all("scene" in axes for _, axes in parts):
        return
    without = next(name for name, axes in parts if "scene" not in axes)
    where = f" in its part `{without}`" if without else ""
    help = "add for example `scene = two_groups`, or name `studies` that it consists of"
    findings.error("E513", f"`{node.name.text}` needs `scene`{where}", node.name.span, help=help)


# ---- comparisons


def _comparison(
    section: Section, parts: Sequence[tuple[str, _Settings]], measure: str, findings: Findings
) -> Comparison:
    """A `compare`; where it names no measure, of that of the study."""
    settings, sections = _read(section.entries, "compare", findings)
    sides: dict[str, _Settings] = {s.name.text: _read(s.entries, s.name.text, findings)[0] for s in sections}
    for side in (settings, *sides.values()):
        _refuse_unknown_cells(side, parts, findings)
    once = {key: known.default for key, known in COMPARED.items()} | {"measure": measure}
    once |= {key: stated.values[0] for key, stated in settings.items() if key in COMPARED}
    first, second = (_selection(sides.get(side, {})) for side in SIDES)
    name = _title(section)
    if not first:
        help = "it selects the rows that are compared, as in `first { strategy = plan_2 }`"
        findings.error("E513", f"`{name}` needs `first`", section.name.span, help=help)
    elif bool(second) == (once["limit"] is not None):
        has = "both `second` and `limit`" if second else "neither `second` nor `limit`"
        help = "`first` is compared with rows that `second` selects, or with a number, the `limit`"
        findings.error("E522", f"`{name}` has {has}", section.name.span, help=help)
    where = _selection({key: stated for key, stated in settings.items() if key not in COMPARED})
    node = settings["measure"].nodes[0] if "measure" in settings else None
    return Comparison(name, first=first, second=second, where=where, node=node, **once)


def _selection(settings: _Settings) -> Selection:
    return {axis: stated.values for axis, stated in settings.items()}


def _refuse_unknown_cells(
    side: _Settings, parts: Sequence[tuple[str, _Settings]], findings: Findings
) -> None:
    """E521 for what selects no row of the study, as far as it was read what its cells have."""
    for axis, stated in side.items():
        if axis in COMPARED or axis == "episode":
            continue
        if axis in findings.broken or (_AXIS, axis) in findings.unclear:
            continue
        known = _values(axis, parts, findings.source.text)
        for value, node in zip(stated.values, stated.nodes, strict=True):
            if value not in known:
                help = f"it has {', '.join(f'`{each}`' for each in known.values())}" if known else ""
                message = f"no cell of this study has this `{axis}`"
                findings.error("E521", message, node.span, help=help)


def _values(axis: str, parts: Sequence[tuple[str, _Settings]], text: str) -> dict[Value, str]:
    """All that the cells of the parts have for an axis, each as it is written."""
    if axis == "part":
        return {name: name for name, _ in parts if name}
    found: dict[Value, str] = {}
    for _, axes in parts:
        if axis in axes:
            stated = axes[axis]
            found |= {
                v: text[n.span.start : n.span.end] for v, n in zip(stated.values, stated.nodes, strict=True)
            }
        else:
            found |= {value: AXES[axis].kind.write(value) for value in _usual(axis)}
    return found


def _usual(axis: str) -> tuple[Value, ...]:
    """What cells may have for an axis of which nothing is said."""
    if axis == "strategy":
        return USUAL_STRATEGIES
    default = AXES[axis].default if axis in AXES else None
    return () if default is None else (default,)


# ---- sections and settings


def _read(
    entries: Sequence[Entry], place: str, findings: Findings
) -> tuple[dict[str, _Stated], list[Section]]:
    """The settings of a section, with those of the scene's sections in it, and its other sections."""
    settings: dict[str, _Stated] = {}
    for entry in entries:
        if isinstance(entry, Listed):
            _state(entry, place, settings, findings)
    others = []
    for section in _sections(entries, place, findings):
        if section.name.text in VARIED:
            inner, _ = _read(section.entries, section.name.text, findings)
            settings |= {f"{section.name.text}.{key}": stated for key, stated in inner.items()}
        else:
            others.append(section)
    return settings, others


def _state(entry: Listed, place: str, settings: dict[str, _Stated], findings: Findings) -> None:
    """Note what a setting says, after its mistakes (E216, E502 to E506)."""
    key, keys = entry.key.text, keys_of(place)
    if key not in keys:
        where = f" in `{place}`" if place else ""
        findings.unknown("E502", "key", key, entry.key.span, keys, where)
        return
    if key in settings:
        findings.error("E216", f"a second `{key}`", entry.key.span)
        return
    if key in ONE_VALUE and len(entry.values) > 1:
        findings.error("E504", f"`{key}` has one value", entry.values[1].span)
    kind, report = keys[key].kind, Report(findings, key)
    found: dict[Value, SettingValue] = {}
    for node in entry.values:
        value = kind.read(node, report)
        if value is None:
            findings.unclear.add((_AXIS, f"{place}.{key}" if place in VARIED else key))
            continue
        value = axis_value(kind, value)
        if value in found:
            findings.error("E216", f"`{key}` lists this twice", node.span)
        found.setdefault(value, node)
    if found:
        settings[key] = _Stated(tuple(found), tuple(found.values()))


def _sections(entries: Sequence[Entry], place: str, findings: Findings) -> list[Section]:
    """The sections that a place may hold, each once, or once by its title (E216, E501)."""
    found: dict[tuple[str, str], Section] = {}
    for section in entries:
        if not isinstance(section, Section):
            continue
        name, title = section.name.text, _title(section)
        if name not in INNER.get(place, ()):
            where = f" in `{place}`" if place else ""
            findings.unknown("E501", "section", name, section.name.span, INNER.get(place, ()), where)
        elif (name, title) in found:
            help = f"the first stands in {findings.line(found[name, title].span)}"
            what = f"{name} `{title}`" if title else f"`{name}` block"
            findings.error("E216", f"a second {what}", section.name.span, help=help)
        else:
            found[name, title] = section
    return list(found.values())


def _title(section: Section) -> str:
    return "" if section.title is None else section.title.text
