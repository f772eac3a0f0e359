"""A scene as text, so that reading what was printed gives the same scene. Lengths are printed in metres."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from cleancli.scene.model import Dirt, Group, Ink, Scattered, Scene
from cleancli.scene.robots import REMOTE
from cleancli.scene.schema import KEYS, TOP


def print_scene(scene: Scene) -> str:
    """A scene as a .nid text, with every setting written out."""
    camera, light, rag, calibration = scene.camera, scene.light, scene.rag, scene.calibration
    zone = scene.zone
    image, path = (camera.image_width, camera.image_height), None if calibration is None else calibration.path
    lines = [
        *_settings(TOP, {"domain": scene.domain, "seed": scene.seed}),
        _section("surface", _named("surface", scene.surface)),
        _section("container", _named("container", scene.container)),
        *([] if zone is None else [_section("zone", _named("zone", zone) | {"at": zone.centre})]),
        _section("robot", _robot(scene)),
        *(_section("grasp", _named("grasp", grasp), grasp.name) for grasp in scene.grasps),
        _section("rag", {"grasp": rag.grasp.name, "width": rag.width}),
        _section(
            "camera",
            {
                "height": camera.height,
                "image": image,
                "focal": camera.focal,
                "at": camera.at,
                "calibration": path,
            },
        ),
        _section("light", _named("light", light) | {"direction": (light.azimuth, light.elevation)}),
        *(["dirt {", *(f"  {_dirt(dirt)}" for dirt in scene.dirt), "}"] if scene.dirt else []),
        _section("symbols", _named("symbols", scene.symbols)),
    ]
    return f"scene {scene.name} {{\n" + "".join(f"  {line}\n" for line in lines) + "}\n"


def _robot(scene: Scene) -> Mapping[str, Any]:
    """What is said of its robot; the arms of a simulated one are known."""
    arms = scene.remote_arms if scene.robot == REMOTE else None
    return {
        "drive": scene.robot,
        "address": scene.address,
        "arms": arms,
        "height_noise": scene.height_noise,
    }


def _dirt(dirt: Dirt) -> str:
    match dirt:
        case Group():
            return _section("group", _named("group", dirt) | {"at": dirt.centre})
        case Scattered():
            return _section("scattered", _named("scattered", dirt) | {"from": dirt.low, "to": dirt.high})
        case Ink():
            return _section("ink", _named("ink", dirt))


def _named(section: str, part: object) -> dict[str, Any]:
    """The values of the keys that a part of the scene has by their own names."""
    return {key: getattr(part, key) for key in KEYS[section] if hasattr(part, key)}


def _section(section: str, values: Mapping[str, Any], title: str = "") -> str:
    name = f"{section} {title}" if title else section
    return f"{name} {{ {'  '.join(_settings(section, values))} }}"


def _settings(section: str, values: Mapping[str, Any]) -> list[str]:
    """All settings of a section in the order of their table, but those that nothing stands for."""
    return [
        f"{key} = {known.kind.write(values[key])}"
        for key, known in KEYS[section].items()
        if values[key] is not None
    ]
