"""What the paper's experiments claim (section 6), by the numbers that studies call them by."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

CLAIMS: Mapping[int, str] = MappingProxyType(
    {
        1: "With two groups, planning takes about as long as the reactive strategy (§6.1).",
        2: "In difficult layouts planning takes much less time than the others (§6.1).",
        3: "The reactive strategy scales worst: it cleans areas one by one (§6.1).",
        4: "The strategy that solves a travelling salesman's problem suffers when an action fails (§6.1).",
        5: "Two actions before planning anew are usually best, and four or more are worse (§6.1).",
        6: "Planning and looking are a small part of the time (§6.1).",
        7: "Looking takes less time where more actions are carried out before planning anew (§6.1).",
        8: "The time for learning fades after a few episodes, and the gain is about a factor of two (§6.3).",
        9: "The decreasing m-estimate does better than the original m-estimate (§6.3).",
    }
)
