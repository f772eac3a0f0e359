"""What perception saw as a Rerun recording (rerun.io): each step of each look, to scrub through in a viewer.

Rerun is heavy and rare, and so an extra. It is imported here alone, and only to write a file: no viewer is
started, nothing is sent anywhere.
"""

from __future__ import annotations

import importlib
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cleancli.array_types import Depth
from cleancli.files.replace import replaced_by
from cleancli.geometry.rgbd import Camera, Frame
from cleancli.language.model import State
from cleancli.perception.area import Area
from cleancli.perception.look import Look
from cleancli.perception.pictures import outline, words

APPLICATION = "cleancli"
CLOCK = "robot"
"""The timeline: seconds of robot time."""

ELLIPSE = (200, 30, 40)


class MissingRerun(Exception):
    """The rerun-sdk isn't installed."""

    def __init__(self) -> None:
        super().__init__("a Rerun recording needs rerun-sdk: pip install 'rerun-sdk>=0.24'")


def find_rerun() -> Any:
    """Rerun's module. Raises MissingRerun."""
    try:
        return importlib.import_module("rerun")
    except ModuleNotFoundError as error:
        if error.name is None or error.name.split(".")[0] != "rerun":
            raise
        raise MissingRerun from error


def write_recording(path: Path, looks: Iterable[Look], name: str) -> None:
    """Write a .rrd file, which holds all looks or is not there. Raises MissingRerun, OSError."""
    rerun = find_rerun()
    with replaced_by(path) as part:
        stream = rerun.RecordingStream(APPLICATION, recording_id=name, send_properties=False)
        stream.save(part)
        for number, look in enumerate(looks):
            _log(rerun, stream, number, look)
        stream.disconnect()


def _log(rerun: Any, stream: Any, number: int, look: Look) -> None:
    stream.set_time("look", sequence=number)
    for frame in look.frames:
        stream.set_time(CLOCK, duration=frame.clock)
        log_frame(rerun, stream, frame)
    steps = look.observation.steps
    masks = {
        "surface": steps.surface,
        "without_edges": steps.without_edges,
        "dirty": steps.dirty,
        "without_specks": steps.without_specks,
        "believed": steps.believed,
        "hidden": look.observation.hidden_mask,
    }
    for step, mask in masks.items():
        stream.log(f"camera/{step}", rerun.SegmentationImage(mask.astype(np.uint8)))
    log_areas(rerun, stream, look.observation.camera, look.areas, look.state)


def log_frame(rerun: Any, stream: Any, frame: Frame) -> None:
    """What a camera saw, from where it stands."""
    camera = frame.camera
    stream.log(
        "camera",
        rerun.Pinhole(
            focal_length=camera.focal,
            principal_point=camera.centre,
            resolution=(camera.width, camera.height),
        ),
        rerun.Transform3D(translation=camera.pose[:3, 3], mat3x3=camera.pose[:3, :3]),
    )
    stream.log("camera/colour", rerun.Image(frame.colour).compress())
    stream.log("camera/depth", rerun.DepthImage(_millimetres(frame.depth), meter=1000.0))


def log_areas(rerun: Any, stream: Any, camera: Camera, areas: Sequence[Area], state: State) -> None:
    """Ellipses with their names on the picture of a `camera`, how many there are, and what is believed."""
    lines = [outline(area.ellipse, camera)[:, 0, :] for area in areas]
    strips = [np.vstack([line, line[:1]]) for line in lines]
    labels = [" ".join([area.name, *words(area.name, state)]) for area in areas]
    stream.log(
        "camera/ellipses",
        rerun.LineStrips2D(strips, labels=labels, colors=[ELLIPSE] * len(strips), show_labels=True),
    )
    told = "\n".join(f"{f.symbol}({', '.join(f.objects)}) = {f.value}" for f in sorted(state, key=str))
    stream.log("state", rerun.TextDocument(told))
    stream.log("areas", rerun.Scalars(float(len(areas))))


def _millimetres(depth: Depth) -> NDArray[np.uint16]:
    known = np.isfinite(depth) & (depth > 0) & (depth < 65)
    return np.asarray(np.rint(np.where(known, depth, 0) * 1000), np.uint16)
