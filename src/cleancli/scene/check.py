"""From syntax to the checked scene: its sections, and whether the parts fit one another. Only dirt must be
given."""

from __future__ import annotations

from collections.abc import Mapping
from math import cos, sin

from cleancli.language.diagnostics.diagnostic import Source
from cleancli.language.diagnostics.refused import Refused
from cleancli.language.diagnostics.sink import Findings
from cleancli.language.load import parse_as
from cleancli.language.syntax import SceneNode, Section
from cleancli.scene.calibration import file_content
from cleancli.scene.check_camera import Read, check_camera
from cleancli.scene.check_dirt import check_dirt, on_surface, refuse_off
from cleancli.scene.grasps import SHIPPED, named
from cleancli.scene.kinds import SLACK, centimetres
from cleancli.scene.model import (
    Container,
    Grasp,
    Light,
    Rag,
    Scene,
    Surface,
    SymbolThresholds,
    Zone,
)
from cleancli.scene.robots import REMOTE
from cleancli.scene.schema import SECTIONS, TOP
from cleancli.scene.settings import Settings

MOST_FLAPS = 60
"""More than the engine's bodies can have (127 links) with an arm above them would be refused there."""


SWERVE = 0.005
"""Metres by which a stroke may go beside where it was meant to: so much less than its half takes a rag along
for sure. Chosen: about the error of a stroke sideways (docs/world.md)."""


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

    def settings(section: str, choices: Mapping[str, tuple[str, ...]] | None = None) -> Settings:
        found = sections.get(section)
        name, entries = (found.name, found.entries) if found else (node.name, ())
        return Settings(section, name, entries, findings, choices)

    top = Settings(TOP, node.name, node.entries, findings)
    surface = Surface(**settings("surface").given())
    container = _container(settings("container"), surface, findings)
    zone = _zone(settings("zone"), surface, findings) if "zone" in sections else None
    robot = settings("robot")
    _check_robot(robot, findings)
    grasps = _grasps(node, findings)
    known = named((*SHIPPED.values(), *grasps))
    rag = _rag(settings("rag", {"grasp": tuple(known)}), container, known, findings)
    camera, calibration = check_camera(settings("camera"), surface, findings, read)
    light = settings("light")
    azimuth, elevation = light["direction"]
    symbols = _symbols(settings("symbols"), rag, findings)
    laid = sections.get("dirt")
    needs_dirt = robot["drive"] != REMOTE or (
        laid is not None and laid.entries
    )  # real dirt lies where it lies
    dirt = check_dirt(laid, node.name, surface, findings) if needs_dirt else ()
    return Scene(
        name=node.name.text,
        surface=surface,
        container=container,
        robot=robot["drive"],
        rag=rag,
        camera=camera,
        dirt=dirt,
        symbols=symbols,
        seed=top["seed"],
        domain=top["domain"],
        grasps=grasps,
        light=Light(azimuth, elevation, light["ambient"], light["gradient"]),
        calibration=calibration,
        zone=zone,
        height_noise=robot["height_noise"],
        address=robot["address"],
        remote_arms=robot["arms"] or 1,
    )


def _check_robot(settings: Settings, findings: Findings) -> None:
    """What only a robot at the end of a socket has, and what only a simulated one has."""
    is_remote, has_address = settings["drive"] == REMOTE, settings.has("address")
    if is_remote and not has_address:
        span, help = settings.span("drive"), 'say where its driver listens: `address = "127.0.0.1:7420"`'
        findings.error("E513", "a remote robot needs `address`", span, help=help)
    if has_address and not is_remote:
        findings.error(
            "E519",
            f"`{settings['drive']}` is simulated, and has no address",
            settings.span("address"),
            help="the robot at that address is `drive = remote`",
        )
    if settings.has("arms") and not is_remote:
        findings.error(
            "E519",
            f"`{settings['drive']}` is simulated, and its arms are known",
            settings.span("arms"),
            help="leave it out: it is a setting of robots at the end of a socket (`drive = remote`)",
        )
    if is_remote and settings.has("height_noise"):
        help = "leave it out: it is a setting of simulated robots"
        findings.error("E519", "a real tool's errors are its own", settings.span("height_noise"), help=help)


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


def _container(settings: Settings, surface: Surface, findings: Findings) -> Container:
    container = Container(**settings.given())
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


def _zone(settings: Settings, surface: Surface, findings: Findings) -> Zone:
    """The zone of a scene that has one; it must lie on the surface whole."""
    zone = Zone(settings["at"] or (0.0, 0.0), settings["side"], settings["turn"])
    reach = zone.side / 2 * (abs(cos(zone.turn)) + abs(sin(zone.turn)))
    if not on_surface(zone.centre, reach, surface):
        refuse_off("zone", "at", settings, surface, findings)
    return zone


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
        settings = Settings("grasp", section.name, section.entries, findings)
        grasps.setdefault(name, Grasp(name, **settings.given()))
    return tuple(grasps.values())


def _rag(settings: Settings, container: Container, known: Mapping[str, Grasp], findings: Findings) -> Rag:
    grasp = known[settings["grasp"]]
    rag = Rag(grasp, grasp.width if settings["width"] is None else settings["width"])
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


def _symbols(settings: Settings, rag: Rag, findings: Findings) -> SymbolThresholds:
    given = settings.given()
    if given["traversal"] is None:
        given["traversal"] = max(rag.width / 2 - SWERVE, rag.width / 4)
    symbols = SymbolThresholds(**given)
    if symbols.medium <= symbols.small:
        findings.error(
            "E511",
            "`medium` must be above `small`",
            settings.span("medium"),
            help=f"an area up to {centimetres(symbols.small)} long is small",
        )
    return symbols
