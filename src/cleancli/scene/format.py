"""A scene as text, so that reading what was printed gives the same scene. Lengths are printed in metres."""

from __future__ import annotations

from cleancli.language.format import print_float
from cleancli.scene.model import Group, Scattered, Scene


def print_scene(scene: Scene) -> str:
    """A scene as a .nid text, with every setting written out."""
    surface, container, camera, symbols = scene.surface, scene.container, scene.camera, scene.symbols
    red, green, blue = surface.colour
    lines = [
        f"domain = {scene.domain}",
        f"seed = {scene.seed}",
        f"surface {{ width = {_m(surface.width)}  depth = {_m(surface.depth)}"
        f"  friction = {print_float(surface.friction)}  colour = rgb({red}, {green}, {blue}) }}",
        f"container {{ edge = {container.edge}  offset = {_m(container.offset)}"
        f"  width = {_m(container.width)}  depth = {_m(container.depth)} }}",
        f"robot {{ drive = {scene.robot} }}",
        f"rag {{ grasp = {scene.rag.grasp}  width = {_m(scene.rag.width)} }}",
        f"camera {{ height = {_m(camera.height)}  image = {camera.image_width} x {camera.image_height}"
        f"  focal = {print_float(camera.focal)} }}",
        "dirt {",
        *(f"  {_dirt(dirt)}" for dirt in scene.dirt),
        "}",
        f"symbols {{ link = {_m(symbols.link)}  small = {_m(symbols.small)}  medium = {_m(symbols.medium)}"
        f"  density = {print_float(symbols.density)}  near = {_m(symbols.near)}"
        f"  traversal = {_m(symbols.traversal)} }}",
    ]
    return f"scene {scene.name} {{\n" + "".join(f"  {line}\n" for line in lines) + "}\n"


def _dirt(dirt: Group | Scattered) -> str:
    if isinstance(dirt, Group):
        return f"group {{ count = {dirt.count}  at = {_point(dirt.centre)}  radius = {_m(dirt.radius)} }}"
    return f"scattered {{ count = {dirt.count}  from = {_point(dirt.low)}  to = {_point(dirt.high)} }}"


def _point(point: tuple[float, float]) -> str:
    return f"({_m(point[0])}, {_m(point[1])})"


def _m(metres: float) -> str:
    return f"{print_float(metres)} m"
