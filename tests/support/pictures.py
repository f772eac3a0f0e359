"""Pictures that commands wrote, read back."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray


def picture(path: Path) -> NDArray[np.uint8 | np.uint16]:
    """(h, w, ...) a picture as it was written, whatever its kind; it must be there."""
    found = cv2.imread(str(path), cv2.IMREAD_UNCHANGED)
    assert found is not None, path
    return np.asarray(found)
