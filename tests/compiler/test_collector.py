"""The collector stands still inside a pause, and goes on as before after it."""

from __future__ import annotations

import gc
from collections.abc import Iterator

import pytest

from cleancli.compiler.collector import paused_collector
from cleancli.compiler.ground import ground
from cleancli.language.diagnostics.refused import Refused
from support.from_text import checked
from support.small_tasks import SECTION_4, TWO_SCATTERED


@pytest.fixture(autouse=True)
def collecting() -> Iterator[None]:
    gc.enable()
    yield
    gc.enable()


def test_pauses_may_lie_in_each_other() -> None:
    with paused_collector():
        assert not gc.isenabled()
        with paused_collector():
            assert not gc.isenabled()
        assert not gc.isenabled(), "the outer pause lasts"
    assert gc.isenabled()


def test_a_pause_ends_with_what_is_raised_in_it() -> None:
    with pytest.raises(ValueError, match="inside"), paused_collector():
        raise ValueError("inside")
    assert gc.isenabled()


def test_whoever_has_turned_it_off_finds_it_off() -> None:
    gc.disable()
    with paused_collector():
        pass
    assert not gc.isenabled()


def test_grounding_leaves_the_collector_as_it_was() -> None:
    ground(*checked(SECTION_4, TWO_SCATTERED))
    assert gc.isenabled()
    twice = SECTION_4.replace("0.5: not dirt(?a)", "0.5: not dirt(?a), dirt(?b)").replace(
        "clean(?a)", "clean(?a, ?b)"
    )
    twice = twice.replace("clean(?a - area)", "clean(?a ?b - area)")
    with pytest.raises(Refused):
        ground(*checked(twice, TWO_SCATTERED))
    assert gc.isenabled()
