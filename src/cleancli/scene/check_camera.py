"""The camera of a scene: where it hangs, whether it sees the whole surface, and its calibration."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

from cleancli.language.diagnostics.sink import Findings
from cleancli.scene.calibration import BadCalibration, Calibration, decode
from cleancli.scene.kinds import SLACK, centimetres
from cleancli.scene.model import CameraSetup, Surface
from cleancli.scene.settings import Settings

Read = Callable[[Path], bytes]
"""How the content of a calibration's file is got; raises OSError."""


def check_camera(
    settings: Settings, surface: Surface, findings: Findings, read: Read
) -> tuple[CameraSetup, Calibration | None]:
    """The camera, and what the file says that its `calibration` names (E516, E517), which `read` reads."""
    width, height = settings["image"]
    camera = CameraSetup(settings["height"], width, height, settings["focal"], settings["at"])
    calibration = _calibration(settings, findings, read)
    if camera.at == (0.0, 0.0):
        _refuse_near_camera(camera, surface, settings, findings)
    else:
        _refuse_hidden_corner(camera, surface, settings, findings)
    return camera, calibration


def _refuse_near_camera(
    camera: CameraSetup, surface: Surface, settings: Settings, findings: Findings
) -> None:
    """Straight above the middle, the picture shows a rectangle of the surface's plane."""
    seen = tuple(side * camera.height / camera.focal for side in (camera.image_width, camera.image_height))
    if seen[0] + SLACK < surface.width or seen[1] + SLACK < surface.depth:
        findings.error(
            "E510",
            "the camera does not see the whole surface",
            settings.span("height"),
            f"it sees {centimetres(seen[0])} x {centimetres(seen[1])}",
            f"the surface is {centimetres(surface.width)} x {centimetres(surface.depth)}: "
            "raise the camera, or shorten `focal`",
        )


def _refuse_hidden_corner(
    camera: CameraSetup, surface: Surface, settings: Settings, findings: Findings
) -> None:
    corners = {
        f"{north}-{east}": (x * surface.width / 2, y * surface.depth / 2)
        for north, y in (("south", -1), ("north", 1))
        for east, x in (("west", -1), ("east", 1))
    }
    hidden = [name for name, corner in corners.items() if not _is_seen(corner, camera)]
    if hidden:
        findings.error(
            "E510",
            "the camera does not see the whole surface",
            settings.span("at"),
            f"the {hidden[0]} corner is outside the picture",
            "raise the camera, shorten `focal`, or move it nearer to the middle",
        )


def _is_seen(corner: tuple[float, float], camera: CameraSetup) -> bool:
    """Whether a place of the surface is in the picture."""
    towards = (corner[0] - camera.at[0], corner[1] - camera.at[1], -camera.height)
    right, down, ahead = (sum(a * b for a, b in zip(axis, towards, strict=True)) for axis in camera.axes())
    return (
        ahead > 0
        and abs(right) / ahead * camera.focal <= camera.image_width / 2 + SLACK
        and abs(down) / ahead * camera.focal <= camera.image_height / 2 + SLACK
    )


def _calibration(settings: Settings, findings: Findings, read: Read) -> Calibration | None:
    """A relative path starts in the folder of the scene's file."""
    path = settings["calibration"]
    if path is None:
        return None
    file = Path(findings.source.path).parent / path
    name = os.path.basename(findings.source.path)
    try:
        return decode(read(file), path)
    except (OSError, ValueError) as error:
        reason = error.strerror if isinstance(error, OSError) else str(error)
        help = f"`cleancli calibrate {name} --out {path}` writes one"
        message = f"cannot read the calibration: {reason}"
        findings.error("E516", message, settings.span("calibration"), help=help)
    except BadCalibration as error:
        message = f"this is no calibration: {error}"
        help = f"`cleancli calibrate {name} --out FILE` writes one"
        findings.error("E517", message, settings.span("calibration"), help=help)
    return None
