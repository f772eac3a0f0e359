"""A scene with some of its settings as a study says them: the one place where a scene is varied."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from cleancli.language.diagnostics.diagnostic import Source
from cleancli.language.diagnostics.refused import Refused
from cleancli.language.load import parse_as
from cleancli.language.syntax import Name, SceneNode, Section, Setting, SettingValue
from cleancli.scene.check import check_scene
from cleancli.scene.format import print_scene
from cleancli.scene.model import Scene


def varied(scene: Source, settings: Mapping[str, SettingValue], study: Source) -> tuple[Scene, Source]:
    """The scene with these settings, by section and key, in place of its own, and its text; without any, the
    text is as it was. Raises Refused with every mistake, also at the places in the study that made them."""
    root, findings = parse_as(scene, "scene")
    if not isinstance(root, SceneNode):
        raise Refused(findings.sorted, [scene])
    if settings:
        findings.include(study, (), frozenset())
        root = _with(root, settings)
    model = check_scene(root, findings)
    findings.refuse_errors()
    return model, Source(scene.path, print_scene(model)) if settings else scene


def _with(node: SceneNode, settings: Mapping[str, SettingValue]) -> SceneNode:
    by_section: dict[str, dict[str, Setting]] = {}
    for axis, value in settings.items():
        section, _, key = axis.partition(".")
        setting = Setting(Name(key, span=value.span), value, span=value.span)
        by_section.setdefault(section, {})[key] = setting
    entries = []
    for entry in node.entries:
        new = by_section.pop(entry.name.text, {}) if isinstance(entry, Section) else {}
        entries.append(_replaced(entry, new) if isinstance(entry, Section) and new else entry)
    for section, new in by_section.items():
        span = next(iter(new.values())).span
        entries.append(Section(Name(section, span=span), None, tuple(new.values()), span=span))
    return replace(node, entries=tuple(entries))


def _replaced(section: Section, new: Mapping[str, Setting]) -> Section:
    kept = (e for e in section.entries if not (isinstance(e, Setting) and e.key.text in new))
    return replace(section, entries=(*kept, *new.values()))
