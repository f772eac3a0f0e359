"""Pictures of a run for people, one a step."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np

from cleancli.array_types import Image
from cleancli.execution.episode_state import Situation
from cleancli.execution.events import Started
from cleancli.files.replace import replace_file
from cleancli.geometry.rgbd import Frame
from cleancli.language.diagnostics.plural import plural
from cleancli.perception.pictures import draw
from cleancli.recording.caption import captioned


def step_picture(frame: Frame, situation: Situation, started: Started | None, room: Image | None) -> Image:
    """What the camera saw, with areas and the coming stroke, beside the room at the stroke's end, if there is
    a picture of that."""
    title, stroke = f"0. first look: {plural(len(situation.areas), 'area')}", None
    if started is not None and started.path is not None:
        title = f"{started.number}. {started.move}"
        stroke = np.array(started.path.stroke).reshape(-1, 2)
    seen = draw(frame, situation.areas, situation.state, stroke)
    if room is None:
        return captioned(seen, (title, ""))
    height = seen.shape[0]
    width = round(room.shape[1] * height / room.shape[0])
    both = np.hstack([seen, cv2.resize(room, (width, height), interpolation=cv2.INTER_AREA)])
    return captioned(both, (title, ""))


def write_png(path: Path, picture: Image) -> None:
    """Write an RGB picture; raises OSError where the file cannot be written."""
    replace_file(path, png_of(picture))


def png_of(picture: Image) -> bytes:
    """An RGB picture as a PNG file holds it."""
    _, data = cv2.imencode(".png", cv2.cvtColor(picture, cv2.COLOR_RGB2BGR))
    return data.tobytes()
