"""The table of what a scene may hold is what the checker takes and what the documentation says."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from cleancli.language.diagnostics.diagnostic import Source
from cleancli.language.diagnostics.refused import Refused
from cleancli.scene.check import load_scene
from cleancli.scene.schema import INNER, KEYS, NEEDED, TOP

ROOT = Path(__file__).parents[2]
INSIDE = {section: outer for outer, sections in INNER.items() for section in sections if outer}


def scene(section: str, key: str) -> str:
    """A scene that gives one key a value that is never right."""
    body = f"{key} = 1 deg"
    while section != TOP:
        title = "own " if section == "grasp" else ""
        body, section = f"{section} {title}{{ {body} }}", INSIDE.get(section, TOP)
    return f"scene s {{ {body} }}"


def codes(text: str) -> set[str]:
    try:
        load_scene(Source("s.nid", text))
    except Refused as refused:
        return {diagnostic.code for diagnostic in refused.diagnostics}
    return set()


@pytest.mark.parametrize(("section", "key"), [(s, k) for s, keys in KEYS.items() for k in keys])
def test_the_checker_knows_every_key(section: str, key: str) -> None:
    assert not {"E501", "E502"} & codes(scene(section, key))
    assert "E502" in codes(scene(section, key + "x"))


def test_every_key_of_the_documentation_is_offered() -> None:
    text = (ROOT / "docs" / "language.md").read_text(encoding="utf-8")
    rows = re.findall(r"^\| (?:`(\w+)`|\(top\)) \| (.+) \|$", text.split("## Scenes")[1], re.M)
    assert len(rows) > 5
    for section, settings in rows:
        for key in re.findall(r"`(\w+) =", settings):
            assert key in KEYS[section], f"{key} in {section or 'the scene'}"
        for inner, keys in re.findall(r"`(\w+) \{ ([\w ]+) \}`", settings):
            assert inner in INNER[section]
            assert set(keys.split()) == set(KEYS[inner])


def test_values_and_units_are_right() -> None:
    for section, keys in KEYS.items():
        for key, known in keys.items():
            for value in (*known.values, *(f"11 {unit}" for unit in known.units)):
                found = codes(scene(section, key).replace("1 deg", value))
                assert not {"E503", "E506"} & found, f"{key} = {value}"


@pytest.mark.parametrize(("section", "key"), [(s, k) for s, keys in KEYS.items() for k in keys])
def test_the_documentation_names_every_key(section: str, key: str) -> None:
    scenes = (ROOT / "docs" / "language.md").read_text(encoding="utf-8").split("## Scenes")[1]
    grasps = scenes.split("### Grasps")[1]
    assert re.search(rf"\b{key}\b", grasps if section == "grasp" else scenes)


def test_each_kind_of_value_is_written_so_that_it_reads_as_itself() -> None:
    for section, keys in KEYS.items():
        for key, known in keys.items():
            if known.default is None or known.default is NEEDED or section == "grasp":
                continue
            body = f"{key} = {known.kind.write(known.default)}"
            text = f"scene s {{ {body} }}" if section == TOP else f"scene s {{ {section} {{ {body} }} }}"
            needs = {"E513"} if any(other.default is NEEDED for other in keys.values()) else set()
            assert codes(text) <= {"E501", "E512"} | needs, text
