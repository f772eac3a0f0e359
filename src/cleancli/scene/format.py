"""A scene as text, so that reading what was printed gives the same scene. Lengths are printed in metres."""

from __future__ import annotations

from cleancli.language.printing.printer import print_float
from cleancli.scene.model import Colour, Dirt, Grasp, Group, Ink, Scattered, Scene


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
        f"  tilt = ({_rad(surface.tilt[0])}, {_rad(surface.tilt[1])})"
        f"  texture = {print_float(surface.texture)}  grain = {_m(surface.grain)} }}",
        f"container {{ edge = {container.edge}  offset = {_m(container.offset)}"
        f"  width = {_m(container.width)}  depth = {_m(container.depth)} }}",
        f"robot {{ drive = {scene.robot} }}",
        *(_grasp(grasp) for grasp in scene.grasps),
        f"rag {{ grasp = {scene.rag.grasp.name}  width = {_m(scene.rag.width)} }}",
        f"camera {{ height = {_m(camera.height)}  image = {camera.image_width} x {camera.image_height}"
        f"  focal = {print_float(camera.focal)}  at = {_point(camera.at)}{_calibration(scene)} }}",
        f"light {{ direction = ({_rad(light.azimuth)}, {_rad(light.elevation)})"
        f"  ambient = {print_float(light.ambient)}  gradient = {print_float(light.gradient)} }}",
        "dirt {",
        *(f"  {_dirt(dirt)}" for dirt in scene.dirt),
        "}",
        f"symbols {{ link = {_m(symbols.link)}  small = {_m(symbols.small)}  medium = {_m(symbols.medium)}"
        f"  density = {print_float(symbols.density)}  near = {_m(symbols.near)}"
        f"  traversal = {_m(symbols.traversal)}  most = {symbols.most}  leave_out = {symbols.leave_out} }}",
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
        case Group(count, centre, radius, of, colour):
            where = f"at = {_point(centre)}  radius = {_m(radius)}"
            return f"group {{ count = {count}  of = {of}  {where}{_colour(colour)} }}"
        case Scattered(count, low, high, of, colour):
            where = f"from = {_point(low)}  to = {_point(high)}"
            return f"scattered {{ count = {count}  of = {of}  {where}{_colour(colour)} }}"
        case Ink(along, width, colour):
            points = ", ".join(map(_point, along))
            return f"ink {{ along = ({points})  width = {_m(width)}{_colour(colour)} }}"


def _colour(colour: Colour | None) -> str:
    return "" if colour is None else f"  colour = rgb{colour}"


def _calibration(scene: Scene) -> str:
    return "" if scene.calibration is None else f'  calibration = "{scene.calibration.path}"'


def _point(point: tuple[float, float]) -> str:
    return f"({_m(point[0])}, {_m(point[1])})"


def _m(metres: float) -> str:
    return f"{print_float(metres)} m"


def _rad(angle: float) -> str:
    return f"{print_float(angle)} rad"
