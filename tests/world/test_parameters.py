"""Where the numbers of the simulated world come from."""

from __future__ import annotations

import inspect
import re
from types import ModuleType

import pytest

from cleancli.motion import pace, pick_up
from cleancli.world import constants
from cleancli.world.robots import constants as robots

SOURCES = re.compile("chosen|measured|manual|published|common figures")


@pytest.mark.parametrize("module", [constants, robots, pace, pick_up])
def test_every_number_names_its_source_or_the_word_chosen(module: ModuleType) -> None:
    for paragraph in re.split(r"\n\s*\n", inspect.getsource(module)):
        if re.search(r"^[A-Z][A-Z_, ]*[:=]", paragraph, re.M):
            said = " ".join(re.findall("#(.*)", paragraph)).lower()
            assert SOURCES.search(said), paragraph
