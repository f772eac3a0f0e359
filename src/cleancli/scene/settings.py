"""Reads the settings of one section of a scene by the table of all settings, and reports what is wrong."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import Any

from cleancli.language.diagnostics.diagnostic import Span
from cleancli.language.diagnostics.sink import Findings
from cleancli.language.syntax import Entry, Name, Setting
from cleancli.scene.kinds import Choice, Report
from cleancli.scene.schema import KEYS, NEEDED, Key


class Settings:
    """The values of a section's keys, those that are left out as well, and where they stand."""

    def __init__(
        self,
        section: str,
        name: Name,
        entries: Iterable[Entry],
        findings: Findings,
        choices: Mapping[str, tuple[str, ...]] | None = None,
    ) -> None:
        """`name` is where missing keys are reported; `choices` of names that this scene alone knows."""
        self._name = name
        self._settings = _each_once(entries, findings)
        keys = KEYS[section]
        for key, words in (choices or {}).items():
            keys = {**keys, key: replace(keys[key], kind=Choice(words))}
        self._values = {key: self._read(key, known, findings) for key, known in keys.items()}
        for key, setting in self._settings.items():
            if key not in keys:
                findings.unknown("E502", "key", key, setting.key.span, keys, f" in `{name.text}`")

    def __getitem__(self, key: str) -> Any:
        """The value of a key, lengths in metres and angles in radians; None where nothing is given for it,
        or what is given is wrong and there is no default."""
        return self._values[key]

    def given(self) -> dict[str, Any]:
        """All values, by their keys."""
        return dict(self._values)

    def has(self, key: str) -> bool:
        """Whether a key is given, rightly or wrongly."""
        return key in self._settings

    def span(self, key: str) -> Span:
        """The place of a value, or of the section's name where the value is a default."""
        setting = self._settings.get(key)
        return self._name.span if setting is None else setting.value.span

    def _read(self, key: str, known: Key, findings: Findings) -> Any:
        setting = self._settings.get(key)
        default = None if known.default is NEEDED else known.default
        if setting is None:
            if known.default is NEEDED:
                findings.error("E513", f"`{self._name.text}` needs `{key}`", self._name.span)
            return default
        value = known.kind.read(setting.value, Report(findings, key))
        return default if value is None else value


def _each_once(entries: Iterable[Entry], findings: Findings) -> dict[str, Setting]:
    settings: dict[str, Setting] = {}
    for entry in entries:
        if not isinstance(entry, Setting):
            continue
        key = entry.key.text
        if key in settings:
            help = f"the first stands in {findings.line(settings[key].span)}"
            findings.error("E216", f"a second `{key}`", entry.key.span, help=help)
        else:
            settings[key] = entry
    return settings
