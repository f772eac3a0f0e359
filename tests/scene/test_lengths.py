"""Lengths that would make a world, or what is seen of it, absurd are located mistakes (docs/language.md)."""

from __future__ import annotations

import pytest

from cleancli.language.diagnostics.diagnostic import Source
from cleancli.language.diagnostics.refused import Refused
from cleancli.scene.check import load_scene

DIRT = "dirt { group { count = 3  at = (0 cm, 0 cm)  radius = 1 cm } }"
LIMITS = [
    ("surface", "width", "10 cm", "9.9 cm", "5 m", "5.001 m"),
    ("surface", "depth", "10 cm", "9.9 cm", "5 m", "5.001 m"),
    ("surface", "grain", "1 mm", "0.99 mm", "50 cm", "50.1 cm"),
    ("container", "width", "1 cm", "9.9 mm", "5 m", "5.001 m"),
    ("container", "depth", "1 cm", "9.9 mm", "5 m", "5.001 m"),
    ("container", "offset", "-10 m", "-10.001 m", "10 m", "10.001 m"),
    ("rag", "width", "1 mm", "0.99 mm", "5 m", "5.001 m"),
    ("grasp loose", "width", "1 mm", "0.99 mm", "5 m", "5.001 m"),
    ("grasp loose", "flap", "1 mm", "0.99 mm", "1 m", "1.001 m"),
    ("grasp loose", "gap_spread", "0 mm", "-1 mm", "1 cm", "1.01 cm"),
    ("grasp loose", "bow", "0 mm", "-1 mm", "10 cm", "10.1 cm"),
    ("camera", "height", "10 cm", "9.9 cm", "10 m", "10.001 m"),
    ("camera", "focal", "10", "9.9", "100000", "100001"),
    ("camera", "at", "(-10 m, 0 m)", "(-10.001 m, 0 m)", "(0 m, 10 m)", "(0 m, 10.001 m)"),
    ("symbols", "link", "1 mm", "0.99 mm", "1 m", "1.001 m"),
    ("symbols", "small", "1 mm", "0.99 mm", "10 m", "10.001 m"),
    ("symbols", "medium", "1 mm", "0.99 mm", "10 m", "10.001 m"),
    ("symbols", "near", "0 m", "-1 mm", "10 m", "10.001 m"),
    ("symbols", "traversal", "1 mm", "0.99 mm", "10 m", "10.001 m"),
]


def out_of_range(text: str) -> list[str]:
    """The parts of a scene that are refused as out of range; other mistakes may follow from the limits."""
    try:
        load_scene(Source("s.nid", text))
    except Refused as refused:
        found = [d.span for d in refused.diagnostics if d.code == "E505"]
        return [text[span.start : span.end] for span in found if span is not None]
    return []


@pytest.mark.parametrize(("section", "key", "low", "below", "high", "above"), LIMITS, ids=lambda word: word)
def test_a_length_has_limits(section: str, key: str, low: str, below: str, high: str, above: str) -> None:
    def scene(value: str) -> str:
        return f"scene s {{ {section} {{ {key} = {value} }} {DIRT} }}"

    for value in (low, high):
        assert out_of_range(scene(value)) == [], value
    for value in (below, above, above.replace(".", "0000000.")):
        (refused,) = out_of_range(scene(value))
        assert refused in value


@pytest.mark.parametrize(
    "dirt",
    [
        "group { count = 3  at = (0 cm, 11 m)  radius = 1 cm }",
        "group { count = 3  at = (0 cm, 0 cm)  radius = 1000000 m }",
        "scattered { count = 3  from = (-11 m, 0 m)  to = (1 cm, 1 cm) }",
        "ink { along = ((0 cm, 0 cm), (1000000 m, 0 m)) }",
        "ink { along = ((0 cm, 0 cm), (1 cm, 0 cm))  width = 0.1 mm }",
    ],
)
def test_dirt_lies_within_them(dirt: str) -> None:
    assert out_of_range(f"scene s {{ dirt {{ {dirt} }} }}")


@pytest.mark.parametrize(
    ("setting", "told"),
    [
        ("surface { width = 6 m }", "this must be from 10 cm to 5 m"),
        ("symbols { near = 11 m }", "this must be at most 10 m"),
    ],
)
def test_a_message_says_between_what_a_length_must_be(setting: str, told: str) -> None:
    with pytest.raises(Refused) as refused:
        load_scene(Source("s.nid", f"scene s {{ {setting} {DIRT} }}"))
    assert told in {diagnostic.message for diagnostic in refused.value.diagnostics}


def test_a_line_of_ink_lies_on_the_surface_with_all_its_width() -> None:
    line = "ink { along = ((0 cm, 0 cm), (%s cm, 0 cm))  width = 2 cm }"
    table = f"scene s {{ surface {{ width = 40 cm }} dirt {{ {line} }} }}"
    load_scene(Source("s.nid", table % 19))
    with pytest.raises(Refused) as refused:
        load_scene(Source("s.nid", table % 19.1))
    assert [diagnostic.code for diagnostic in refused.value.diagnostics] == ["E508"]
