"""The numbers that modules and records state are those that were fixed before anything was measured.

Whoever changes one regenerates the list (CLEANCLI_REGENERATE=1), and measures again what the documents state.
"""

from __future__ import annotations

import ast
import importlib
import os
from collections.abc import Iterator, Mapping
from dataclasses import asdict, fields, is_dataclass
from enum import Enum
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np

ROOT = Path(__file__).parent.parent
SOURCES = ROOT / "src" / "cleancli"
LIST = Path(__file__).parent / "golden" / "numbers.txt"
LONGEST = 1000
"""Longer ones are tables that are computed."""
OF_THE_SYSTEM = ("_NO_WAIT", "RULE_LIMIT", "PART_LIMIT")


def stated(path: Path) -> Iterator[str]:
    """The constants that a module states."""
    for node in ast.parse(path.read_text(encoding="utf-8")).body:
        targets = node.targets if isinstance(node, ast.Assign) else [getattr(node, "target", None)]
        for target in targets:
            if isinstance(target, ast.Name) and target.id.upper() == target.id:
                yield target.id
            elif isinstance(target, ast.Tuple):
                yield from (name.id for name in target.elts if isinstance(name, ast.Name))


def numbers(value: Any) -> Any:
    """A value of numbers as text; None for anything else."""
    if isinstance(value, Enum):
        return None
    if isinstance(value, np.ndarray):
        return numbers(value.tolist())
    if isinstance(value, bool | int | float):
        return f"{value:.9g}"
    if is_dataclass(value) and not isinstance(value, type):
        return numbers(asdict(value))
    if isinstance(value, Mapping):
        parts = {key: numbers(part) for key, part in value.items()}
        return None if None in parts.values() or not parts else str(parts).replace("'", "")
    if isinstance(value, tuple | list):
        several = [numbers(part) for part in value]
        return None if None in several or not several else f"({', '.join(several)})"
    return value if isinstance(value, str) and len(value) < 20 else None


def defaults(module: ModuleType) -> Iterator[tuple[str, Any]]:
    """What the records of a module hold unless told otherwise, by `Record.field`."""
    for name, kind in vars(module).items():
        if isinstance(kind, type) and is_dataclass(kind) and kind.__module__ == module.__name__:
            yield from ((f"{name}.{each.name}", each.default) for each in fields(kind))


def parts(name: str, value: Any) -> Iterator[tuple[str, str]]:
    """A value of numbers as text, or of a table or a record each part that is one, by `name.key`."""
    told = None if isinstance(value, str) else numbers(value)
    if told is not None:
        yield name, told
    elif isinstance(value, Mapping):
        for key, part in value.items():
            yield from parts(f"{name}.{key}", part)
    elif is_dataclass(value) and not isinstance(value, type):
        for each in fields(value):
            yield from parts(f"{name}.{each.name}", getattr(value, each.name))


def lines() -> Iterator[str]:
    for path in sorted(SOURCES.rglob("*.py")):
        dotted = ".".join(path.relative_to(SOURCES).with_suffix("").parts)
        if path.name in ("__init__.py", "__main__.py"):
            continue
        module = importlib.import_module(f"cleancli.{dotted}")
        constants = [(name, getattr(module, name)) for name in stated(path)]
        for name, value in (*constants, *defaults(module)):
            for place, told in () if name in OF_THE_SYSTEM else parts(name, value):
                if any(map(str.isdigit, told)) and len(told) < LONGEST:
                    yield f"{dotted}.{place} = {told}"


def test_numbers_are_as_they_were_fixed() -> None:
    text = "".join(f"{line}\n" for line in lines())
    if os.environ.get("CLEANCLI_REGENERATE"):
        LIST.write_text(text, encoding="utf-8")
    assert text.splitlines() == LIST.read_text(encoding="utf-8").splitlines()
