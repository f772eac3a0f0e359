"""Signals that come in a section that they shall not interrupt are kept until it is over."""

from __future__ import annotations

import signal

import pytest

from cleancli.files.interrupt import ENDING, undisturbed


@pytest.mark.parametrize("number", sorted(set(ENDING)))
def test_a_signal_waits_and_then_comes_once(number: int) -> None:
    came: list[int] = []
    before = signal.signal(number, lambda number, frame: came.append(number))
    try:
        with undisturbed():
            signal.raise_signal(number)
            with undisturbed():
                assert came == []
            assert came == []
        assert came == [number]
        signal.raise_signal(number)
        assert came == [number, number], "its handler is back"
    finally:
        signal.signal(number, before)
