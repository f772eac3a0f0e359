"""A scene as text, so that reading what was printed gives the same scene. Lengths are printed in metres."""

from __future__ import annotations

from cleancli.language.format import print_float
from cleancli.scene.model import Dirt, Grasp, Group, Ink, Scattered, Scene


def print_scene(scene: Scene) -> str:
    """A scene as a .nid text, with every setting written out."""
    surface, container, camera, symbols = scene.surface, scene.container, scene.camera, scene.symbols
    light = scene.light
    red, green, blue = surface.colour
    lines = [
        f"domain = {scene.domain}",
        f"seed = {scene.seed}",
        f"surface {{ width = {_m(surface.width)}  depth = {_m(surface.depth)}"
        f"  friction = {print_float(surface.friction)}  colour = rgb({red}, {green}, {blue})"
        f"  tilt = ({_rad(surface.tilt[0])}, {_rad(surface.tilt[1])}) }}",
        f"container {{ edge = {container.edge}  offset = {_m(container.offset)}"
        f"  width = {_m(container.width)}  depth = {_m(container.depth)} }}",
        f"robot {{ drive = {scene.robot} }}",
        *(_grasp(grasp) for grasp in scene.grasps),
        f"rag {{ grasp = {scene.rag.grasp.name}  width = {_m(scene.rag.width)} }}",
        f"camera {{ height = {_m(camera.height)}  image = {camera.image_width} x {camera.image_height}"
        f"  focal = {print_float(camera.focal)} }}",
        f"light {{ direction = ({_rad(light.azimuth)}, {_rad(light.elevation)})"
        f"  ambient = {print_float(light.ambient)} }}",
        "dirt {",
        *(f"  {_dirt(dirt)}" for dirt in scene.dirt),
        "}",
        f"symbols {{ link = {_m(symbols.link)}  small = {_m(symbols.small)}  medium = {_m(symbols.medium)}"
        f"  density = {print_float(symbols.density)}  near = {_m(symbols.near)}"
        f"  traversal = {_m(symbols.traversal)} }}",
    ]
    return f"scene {scene.name} {{\n" + "".join(f"  {line}\n" for line in lines) + "}\n"


def _grasp(grasp: Grasp) -> str:
    return (
        f"grasp {grasp.name} {{ flap = {_m(grasp.flap)}  gain = {print_float(grasp.gain)}"
        f"  torque = {print_float(grasp.torque)}  angle_spread = {_rad(grasp.angle_spread)}"
        f"  gap_spread = {_m(grasp.gap_spread)}  bow = {_m(grasp.bow)}  sweep = {_rad(grasp.sweep)}"
        f"  skew = {_rad(grasp.skew)}  width = {_m(grasp.width)} }}"
    )


def _dirt(dirt: Dirt) -> str:
    match dirt:
        case Group(count, centre, radius, of):
            return f"group {{ count = {count}  of = {of}  at = {_point(centre)}  radius = {_m(radius)} }}"
        case Scattered(count, low, high, of):
            return f"scattered {{ count = {count}  of = {of}  from = {_point(low)}  to = {_point(high)} }}"
        case Ink(along, width):
            return f"ink {{ along = ({', '.join(map(_point, along))})  width = {_m(width)} }}"


def _point(point: tuple[float, float]) -> str:
    return f"({_m(point[0])}, {_m(point[1])})"


def _m(metres: float) -> str:
    return f"{print_float(metres)} m"


def _rad(angle: float) -> str:
    return f"{print_float(angle)} rad"
