"""A run's pictures, small enough to stand inside a page."""

from __future__ import annotations

import base64
from pathlib import Path

import cv2
import numpy as np

from cleancli.files.plain import NotPlain, TooLarge, read_plain
from cleancli.files.untrusted import is_whole_png, png_size

WIDEST = 1200
"""Pixels; wider pictures are made smaller. Chosen: the page shows them at most so wide."""

LARGEST = 64 << 20
"""Bytes of a picture."""

MOST_PIXELS = 64 << 20
"""Of a picture, which its header tells before memory is taken. Chosen: more than twice what a run writes. A
scene's image has at most as many as 1920 x 1080 and is at most 4096 high, and the room beside it is as high
and a third wider than that."""

QUALITY = 80
"""Of WebP, out of 100. Chosen: text in the pictures stays clear, and one takes some 40 kB."""


def data_uri(path: Path) -> str | None:
    """The picture as the text that an `img` takes for its address; None where there is none, where a crash
    has left half of one, or where it is no PNG picture of a size that a step's picture may have."""
    try:
        content = read_plain(path, LARGEST, follow=False)
        width, height = png_size(content) or (0, 0)
        if not 0 < width * height <= MOST_PIXELS or not is_whole_png(content):
            return None
        picture = cv2.imdecode(np.frombuffer(content, np.uint8), cv2.IMREAD_COLOR)
    except (FileNotFoundError, NotPlain, TooLarge, cv2.error):
        return None
    if picture is None:
        return None
    height, width = picture.shape[:2]
    if width > WIDEST:
        picture = cv2.resize(picture, (WIDEST, round(height * WIDEST / width)), interpolation=cv2.INTER_AREA)
    _, data = cv2.imencode(".webp", picture, (cv2.IMWRITE_WEBP_QUALITY, QUALITY))
    return f"data:image/webp;base64,{base64.b64encode(data.tobytes()).decode()}"
