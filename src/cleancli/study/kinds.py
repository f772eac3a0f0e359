"""The kinds of values that settings of a study have, beside those that a scene's have too."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Any, ClassVar

from cleancli.language.syntax import Quoted, SettingValue, Word
from cleancli.scene.kinds import Choice, Kind, Report

_NAME = re.compile(r"[A-Za-z_]\w*", re.ASCII)


def spelled(name: str) -> str:
    """A name of an option as a study writes it, which has words of letters, digits and `_` alone."""
    return name.replace("-", "_").replace("+", "_plus")


@dataclass(frozen=True, slots=True)
class Option(Choice):
    """One of some `names`, as options of commands have them; `choices` are as a study writes them."""

    names: tuple[str, ...] = ()

    def read(self, value: SettingValue, report: Report) -> str | None:
        word = Choice.read(self, value, report)
        return None if word is None else self.names[(self.choices or ()).index(word)]

    def write(self, value: str) -> str:
        return spelled(value)


def option(*names: str) -> Option:
    """One of these names."""
    return Option(tuple(map(spelled, names)), names=names)


@dataclass(frozen=True, slots=True)
class Named:
    """The name of a shipped file, or of something in this one, or a path in quotation marks."""

    units: ClassVar[tuple[str, ...]] = ()
    what: str

    def read(self, value: SettingValue, report: Report) -> str | None:
        if not isinstance(value, Word | Quoted):
            report.wrong(value, self.what)
            return None
        return value.text

    def write(self, value: str) -> str:
        return value if _NAME.fullmatch(value) else f'"{value}"'


@dataclass(frozen=True, slots=True)
class Text:
    """A text in quotation marks."""

    units: ClassVar[tuple[str, ...]] = ()

    def read(self, value: SettingValue, report: Report) -> str | None:
        if not isinstance(value, Quoted):
            report.wrong(value, "a text in quotation marks")
            return None
        return value.text

    def write(self, value: str) -> str:
        return f'"{value}"'


def axis_value(kind: Kind, value: Any) -> str | int | float:
    """A value of this kind as rows have it: numbers and names as they are, all else as it is written."""
    return value if isinstance(value, str | int | float) else kind.write(value)
