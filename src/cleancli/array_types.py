"""Types of arrays by the names that all packages call them: what an element is, and of some the shape too.

Other shapes stand where an array is defined. `(n, 2)` is two columns; `(n,)` has no columns.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Singles = NDArray[np.float32]
Ints = NDArray[np.int32]
Longs = NDArray[np.int64]
Bools = NDArray[np.bool_]

Indices = NDArray[np.uint32]
"""Not signed, so that compiled code need not ask whether one counts from an array's end: a quarter of its
time."""

Words = NDArray[np.uint64]
"""Bits in groups of 64, or hashes."""

Points = NDArray[np.float64]
"""(n, 2) or (n, 3) in metres."""

Image = NDArray[np.uint8]
"""Colours, (height, width, 3): red, green, blue."""

Depth = NDArray[np.float32]
"""Metres along the view, (height, width)."""

Mask = NDArray[np.bool_]
"""Which pixels of an image, (height, width)."""
