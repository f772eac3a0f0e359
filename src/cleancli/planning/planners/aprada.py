"""A-PRADA (Lang and Toussaint 2010): PRADA's sequence without the actions that it is better off without."""

from __future__ import annotations

import numpy as np

from cleancli.array_types import Ints
from cleancli.planning.compiled_task import Prepared
from cleancli.planning.plan import Options, Plan
from cleancli.planning.planners.prada import PradaOptions, Worth, best_sampled
from cleancli.planning.preference import preferred


def aprada(prepared: Prepared, options: Options, own: PradaOptions) -> Plan:
    """PRADA's best sequence, shortened while that is no worse; empty where it is not worth `margin` more than
    doing nothing."""
    return best_sampled("aprada", prepared, options, own, _shortened)


def _shortened(actions: Ints, worth: Worth) -> Ints:
    """The sequence less one action at a time, each time the one without which it is worth most."""
    (known,) = zip(*worth([actions]), strict=True)
    while actions.size:
        shorter = [np.delete(actions, place) for place in range(actions.size)]
        found = list(zip(*worth(shorter), strict=True))
        best = 0
        for place in range(1, len(shorter)):
            if preferred(*found[place], *found[best]):
                best = place
        if preferred(*known, *found[best]):
            break
        actions, known = shorter[best], found[best]
    return actions
