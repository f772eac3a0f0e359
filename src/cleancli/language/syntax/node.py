"""What every node of the syntax tree is: frozen, slotted, and equal to any other that says the same.

A node class states its fields as a dataclass does. Its methods are written once here: a dataclass compiles
its own, and for all nodes of the language that takes longer than checking a file does.
"""

from __future__ import annotations

from dataclasses import FrozenInstanceError, field
from typing import Any, NoReturn, dataclass_transform

from cleancli.language.diagnostics import Span


@dataclass_transform(frozen_default=True, field_specifiers=(field,))
class _NodeType(type):
    """Makes slots of the fields that a class states; `_defaults` are values for some of them."""

    _defaults: dict[str, Any]

    def __new__(mcs, name: str, bases: tuple[type, ...], namespace: dict[str, Any]) -> _NodeType:
        own = tuple(namespace.get("__annotations__", ()))
        defaults = {field: namespace.pop(field) for field in own if field in namespace}
        made = super().__new__(mcs, name, bases, {**namespace, "__slots__": own, "__match_args__": own})
        made._defaults = defaults
        return made


class Node(metaclass=_NodeType):
    """Anything that stands in the text. Fields are given by place, the span by name; equality ignores it."""

    span: Span = field(kw_only=True)

    def __init__(self, *values: object, span: Span) -> None:
        names = fields(self)
        if len(values) < len(names):
            values += tuple(type(self)._defaults[name] for name in names[len(values) :])
        object.__setattr__(self, "span", span)
        for name, value in zip(names, values, strict=True):
            object.__setattr__(self, name, value)

    def __setattr__(self, name: str, value: object) -> NoReturn:
        raise FrozenInstanceError(f"cannot assign to field {name!r}")

    def __delattr__(self, name: str) -> NoReturn:
        raise FrozenInstanceError(f"cannot delete field {name!r}")

    def __eq__(self, other: object) -> bool:
        return type(self) is type(other) and _said(self) == _said(other)

    def __hash__(self) -> int:
        return hash((type(self), _said(self)))

    def __repr__(self) -> str:
        return f"{type(self).__name__}({', '.join(map(repr, _said(self)))})"


def fields(node: Node | type[Node]) -> tuple[str, ...]:
    """The names of a node's fields in the order in which they are given, without its span."""
    return node.__match_args__


def _said(node: Any) -> tuple[object, ...]:
    return tuple(getattr(node, name) for name in fields(node))
