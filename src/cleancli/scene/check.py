"""From syntax to the checked scene: sections, defaults, and whether the parts fit one another.

The defaults are choices, nobody's measurement: those of problems/two_groups.nid. Only dirt must be given.
"""

from __future__ import annotations

from collections.abc import Mapping

from cleancli.language.diagnostics.diagnostic import Refused, Source
from cleancli.language.diagnostics.sink import Findings
from cleancli.language.load import parse_as
from cleancli.language.syntax import SceneNode, Section
from cleancli.scene.calibration import file_content
from cleancli.scene.check_camera import Read, check_camera
from cleancli.scene.check_dirt import check_dirt
from cleancli.scene.grasps import SHIPPED, WIDE, named
from cleancli.scene.model import (
    LIGHT,
    Container,
    Grasp,
    Light,
    Rag,
    Scene,
    Surface,
    SymbolThresholds,
)
from cleancli.scene.settings import SLACK, Settings, centimetres

EDGES = ("north", "east", "south", "west")
DRIVES = ("gantry", "wam", "reem")
SECTIONS = ("surface", "container", "robot", "grasp", "rag", "camera", "light", "dirt", "symbols")
LEFT_OUT = ("smallest", "farthest")
MOST_FLAPS = 60
"""More than the engine's bodies can have (127 links) with an arm above them would be refused there."""


def load_scene(source: Source, read: Read = file_content) -> Scene:
    """The checked scene; raises Refused with every mistake. `read` gets the content of a calibration's file,
    where it is not the one on disk."""
    root, findings = parse_as(source, "scene")
    if not isinstance(root, SceneNode):
        raise Refused(findings.sorted, [source])
    scene = check_scene(root, findings, read)
    findings.refuse_errors()
    return scene


def check_scene(node: SceneNode, findings: Findings, read: Read = file_content) -> Scene:
    """The model of a scene; it may only be used if `findings` holds no error."""
    sections = _sections(node, findings)

    def settings(name: str) -> Settings:
        section = sections.get(name)
        return Settings(section.name if section else node.name, section.entries if section else (), findings)

    top = Settings(node.name, node.entries, findings)
    domain, seed = top.word("domain", "cleaning"), top.whole("seed", 1, 0, 2**31 - 1)
    top.refuse_others()
    surface = _surface(settings("surface"))
    container = _container(settings("container"), surface, findings)
    drive = settings("robot")
    robot = drive.word("drive", "gantry", DRIVES)
    drive.refuse_others()
    grasps = _grasps(node, findings)
    rag = _rag(settings("rag"), container, named((*SHIPPED.values(), *grasps)), findings)
    camera, calibration = check_camera(settings("camera"), surface, findings, read)
    light = _light(settings("light"))
    symbols = _symbols(settings("symbols"), findings)
    dirt = check_dirt(sections.get("dirt"), node.name, surface, findings)
    return Scene(
        node.name.text,
        surface,
        container,
        robot,
        rag,
        camera,
        dirt,
        symbols,
        seed,
        domain,
        grasps,
        light,
        calibration,
    )


def _sections(node: SceneNode, findings: Findings) -> dict[str, Section]:
    sections: dict[str, Section] = {}
    for entry in node.entries:
        if not isinstance(entry, Section):
            continue
        name = entry.name.text
        if name not in SECTIONS:
            findings.unknown("E501", "section", name, entry.name.span, SECTIONS)
        elif name in sections and name != "grasp":
            findings.error(
                "E216",
                f"a second `{name}` block",
                entry.name.span,
                help=f"the first stands in {findings.line(sections[name].span)}",
            )
        sections.setdefault(name, entry)
        if name != "dirt":
            for inner in entry.entries:
                if isinstance(inner, Section):
                    findings.error("E501", f"`{name}` has no sections", inner.name.span)
    return sections


def _surface(settings: Settings) -> Surface:
    surface = Surface(
        settings.length("width", 0.90, least=0.1, most=5.0),
        settings.length("depth", 0.70, least=0.1, most=5.0),
        settings.number("friction", 0.45, 0, 2),
        settings.colour("colour", (205, 198, 184)),
        settings.angles("tilt", (0.0, 0.0), (-10, 10), (-10, 10)),
        settings.number("texture", 0.0, 0, 0.3, including=True),
        settings.length("grain", 0.01, least=0.001, most=0.5),
    )
    settings.refuse_others()
    return surface


def _container(settings: Settings, surface: Surface, findings: Findings) -> Container:
    container = Container(
        settings.word("edge", "east", EDGES),
        settings.length("offset", 0.0, negative=True),
        settings.length("width", 0.32, least=0.01, most=5.0),
        settings.length("depth", 0.16, least=0.01, most=5.0),
    )
    settings.refuse_others()
    edge = surface.width if container.edge in ("north", "south") else surface.depth
    if abs(container.offset) + container.width / 2 > edge / 2 + SLACK:
        key = "offset" if container.width <= edge else "width"
        findings.error(
            "E507",
            "the container stands out beyond the edge of the table",
            settings.span(key),
            help=f"the {container.edge} edge is {centimetres(edge)} long: "
            f"|offset| + width / 2 may be {centimetres(edge / 2)} at most",
        )
    return container


def _grasps(node: SceneNode, findings: Findings) -> tuple[Grasp, ...]:
    """The grasps that the scene defines, in its order; what a block leaves out is as in `wide`."""
    grasps: dict[str, Grasp] = {}
    for section in node.entries:
        if not isinstance(section, Section) or section.title is None:
            continue
        name = section.title.text
        if name in SHIPPED or name in grasps:
            whose = "of those that ship with cleancli" if name in SHIPPED else "of this scene"
            findings.error("E216", f"a second grasp `{name}`", section.title.span, help=f"one {whose} has it")
        grasps.setdefault(name, _grasp(name, Settings(section.name, section.entries, findings)))
    return tuple(grasps.values())


def _grasp(name: str, settings: Settings) -> Grasp:
    grasp = Grasp(
        name,
        settings.length("flap", WIDE.flap, least=0.001, most=1.0),
        settings.number("gain", WIDE.gain, 0, 1),
        settings.number("torque", WIDE.torque, 0, 10),
        settings.angle("angle_spread", WIDE.angle_spread, 0, 30),
        settings.length("gap_spread", WIDE.gap_spread, zero=True, most=0.01),
        settings.length("bow", WIDE.bow, zero=True, most=0.1),
        settings.angle("sweep", WIDE.sweep, 0, 45),
        settings.angle("skew", WIDE.skew, -45, 45),
        settings.length("width", WIDE.width, least=0.001, most=5.0),
    )
    settings.refuse_others()
    return grasp


def _rag(settings: Settings, container: Container, known: Mapping[str, Grasp], findings: Findings) -> Rag:
    grasp = known[settings.word("grasp", "wide", known)]
    rag = Rag(grasp, settings.length("width", grasp.width, least=0.001, most=5.0))
    settings.refuse_others()
    if rag.width > container.width + SLACK:
        findings.error(
            "E509",
            "the rag is wider than the container",
            settings.span("width"),
            help=f"the container is {centimetres(container.width)} wide",
        )
    elif not 1 <= round(rag.width / grasp.flap) <= MOST_FLAPS:
        findings.error(
            "E509",
            f"a rag of {centimetres(rag.width)} can't hang in flaps of {centimetres(grasp.flap)}",
            settings.span("width"),
            help=f"that would be {round(rag.width / grasp.flap)} flaps: from 1 to {MOST_FLAPS} are possible",
        )
    return rag


def _light(settings: Settings) -> Light:
    azimuth, elevation = settings.angles("direction", (LIGHT.azimuth, LIGHT.elevation), (-360, 360), (5, 90))
    light = Light(
        azimuth,
        elevation,
        settings.number("ambient", LIGHT.ambient, 0, 1),
        settings.number("gradient", LIGHT.gradient, 0, 0.9, including=True),
    )
    settings.refuse_others()
    return light


def _symbols(settings: Settings, findings: Findings) -> SymbolThresholds:
    symbols = SymbolThresholds(
        settings.length("link", 0.05, least=0.001, most=1.0),
        settings.length("small", 0.06, least=0.001),
        settings.length("medium", 0.12, least=0.001),
        settings.number("density", 0.14, 0, 1),
        settings.length("near", 0.20, zero=True),
        settings.length("traversal", 0.05, least=0.001),
        settings.whole("most", 1000, 1, 1000),
        settings.word("leave_out", "smallest", LEFT_OUT),
    )
    settings.refuse_others()
    if symbols.medium <= symbols.small:
        findings.error(
            "E511",
            "`medium` must be above `small`",
            settings.span("medium"),
            help=f"an area up to {centimetres(symbols.small)} long is small",
        )
    return symbols
