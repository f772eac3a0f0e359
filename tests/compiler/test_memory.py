"""A task may take half of the least that machine, limit and container allow."""

from __future__ import annotations

import os
import resource
from pathlib import Path

import pytest

from cleancli.compiler import memory

GIGABYTE = 10**9


@pytest.fixture(autouse=True)
def ten_gigabytes(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Path:
    """A machine of that size without limits; returns where a container's limit may be written."""
    place = tmp_path / "memory.max"
    sizes = {"SC_PHYS_PAGES": 10_000_000, "SC_PAGE_SIZE": 1000}
    monkeypatch.setattr(os, "sysconf", sizes.__getitem__)
    monkeypatch.setattr(resource, "getrlimit", lambda _: (resource.RLIM_INFINITY,) * 2)
    monkeypatch.setattr(memory, "_OF_CONTAINERS", (str(place), str(tmp_path / "missing")))
    return place


def test_half_of_the_machine() -> None:
    assert memory.most_bytes() == 5 * GIGABYTE


@pytest.mark.parametrize(("said", "most"), [("4000000000\n", 2), ("max\n", 5), ("99000000000\n", 5)])
def test_half_of_the_container(said: str, most: int, ten_gigabytes: Path) -> None:
    ten_gigabytes.write_text(said)
    assert memory.most_bytes() == most * GIGABYTE


def test_half_of_the_limit(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(resource, "getrlimit", lambda _: (6 * GIGABYTE, resource.RLIM_INFINITY))
    assert memory.most_bytes() == 3 * GIGABYTE
