"""The robots that a scene may have. What one looks like and how it moves is in world/robots."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

ARMS: Mapping[str, int] = MappingProxyType({"gantry": 1, "wam": 1, "reem": 2})
"""The simulated ones, and how many arms each has: picking up takes two (§3.2.2)."""

REMOTE = "remote"
"""The robot at the end of a socket (docs/protocol.md)."""

DRIVES = (*ARMS, REMOTE)
