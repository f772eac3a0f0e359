"""Settings, and the sections of scenes and studies, which are made of them."""

from __future__ import annotations

from cleancli.language.syntax.node import Node
from cleancli.language.syntax.words import Name, Number, Quantity


class Pair(Node):
    """`(x, y)`."""

    x: Quantity
    y: Quantity


class Points(Node):
    """`((x, y), ...)`."""

    points: tuple[Pair, ...]


class ImageSize(Node):
    """`width x height`."""

    width: Number
    height: Number


class Call(Node):
    """`name(numbers)`."""

    name: Name
    arguments: tuple[Number, ...]


class Word(Node):
    """A name as a value."""

    text: str


class Quoted(Node):
    """A text in quotation marks, as one that has other signs than letters, digits and `_` must be."""

    text: str


SettingValue = Quantity | Pair | Points | ImageSize | Call | Word | Quoted


class Setting(Node):
    """`key = value`."""

    key: Name
    value: SettingValue


class Listed(Node):
    """`key = value, ...`, in studies."""

    key: Name
    values: tuple[SettingValue, ...]


class Section(Node):
    """`name { entries }`, or `name title { entries }` for one of several that are told apart by a title."""

    name: Name
    title: Name | None
    entries: tuple[Entry, ...]


Entry = Setting | Listed | Section


class SceneNode(Node):
    """A whole scene."""

    name: Name
    entries: tuple[Entry, ...]


class StudyNode(Node):
    """A whole study."""

    name: Name
    entries: tuple[Entry, ...]
