"""From syntax to the checked scene: sections, defaults, and whether the parts fit one another.

The defaults are choices, nobody's measurement: those of problems/two_groups.nid. Only dirt must be given.
"""

from __future__ import annotations

from collections.abc import Callable

from cleancli.language.diagnostics import Refused, Source
from cleancli.language.findings import Findings
from cleancli.language.load import parse_as
from cleancli.language.syntax import Name, SceneNode, Section
from cleancli.scene.model import (
    CameraSetup,
    Container,
    Group,
    Rag,
    Scattered,
    Scene,
    Surface,
    SymbolThresholds,
)
from cleancli.scene.settings import Settings

EDGES = ("north", "east", "south", "west")
GRASPS = ("wide",)
DRIVES = ("gantry",)
SECTIONS = ("surface", "container", "robot", "rag", "camera", "dirt", "symbols")
MOST_LENTILS = 500
"""Of one group: far more than any table of the paper has (40), few enough to simulate."""

_SLACK = 1e-9
"""Metres by which sums of rounded lengths may miss a limit they equal."""


def load_scene(source: Source) -> Scene:
    """The checked scene; raises Refused with every mistake."""
    root, findings = parse_as(source, "scene")
    if not isinstance(root, SceneNode):
        raise Refused(findings.sorted, [source])
    scene = check_scene(root, findings)
    findings.refuse_errors()
    return scene


def check_scene(node: SceneNode, findings: Findings) -> Scene:
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
    rag = _rag(settings("rag"), container, findings)
    camera = _camera(settings("camera"), surface, findings)
    symbols = _symbols(settings("symbols"), findings)
    dirt = _dirt(sections.get("dirt"), node.name, surface, findings)
    return Scene(node.name.text, surface, container, robot, rag, camera, dirt, symbols, seed, domain)


def _sections(node: SceneNode, findings: Findings) -> dict[str, Section]:
    sections: dict[str, Section] = {}
    for entry in node.entries:
        if not isinstance(entry, Section):
            continue
        name = entry.name.text
        if name not in SECTIONS:
            findings.unknown("E501", "section", name, entry.name.span, SECTIONS)
        elif name in sections:
            findings.error(
                "E216",
                f"a second `{name}` block",
                entry.name.span,
                help=f"the first stands in line {findings.line(sections[name].span)}",
            )
        sections.setdefault(name, entry)
        if name != "dirt":
            for inner in entry.entries:
                if isinstance(inner, Section):
                    findings.error("E501", f"`{name}` has no sections", inner.name.span)
    return sections


def _surface(settings: Settings) -> Surface:
    surface = Surface(
        settings.length("width", 0.90),
        settings.length("depth", 0.70),
        settings.number("friction", 0.45, 0, 2),
        settings.colour("colour", (205, 198, 184)),
    )
    settings.refuse_others()
    return surface


def _container(settings: Settings, surface: Surface, findings: Findings) -> Container:
    container = Container(
        settings.word("edge", "east", EDGES),
        settings.length("offset", 0.0, negative=True),
        settings.length("width", 0.32),
        settings.length("depth", 0.16),
    )
    settings.refuse_others()
    edge = surface.width if container.edge in ("north", "south") else surface.depth
    if abs(container.offset) + container.width / 2 > edge / 2 + _SLACK:
        key = "offset" if container.width <= edge else "width"
        findings.error(
            "E507",
            "the container stands out beyond the edge of the table",
            settings.span(key),
            help=f"the {container.edge} edge is {_cm(edge)} long: "
            f"|offset| + width / 2 may be {_cm(edge / 2)} at most",
        )
    return container


def _rag(settings: Settings, container: Container, findings: Findings) -> Rag:
    rag = Rag(settings.word("grasp", "wide", GRASPS), settings.length("width", 0.12))
    settings.refuse_others()
    if rag.width > container.width + _SLACK:
        findings.error(
            "E509",
            "the rag is wider than the container",
            settings.span("width"),
            help=f"the container is {_cm(container.width)} wide",
        )
    return rag


def _camera(settings: Settings, surface: Surface, findings: Findings) -> CameraSetup:
    height = settings.length("height", 0.9)
    width, depth = settings.image("image", (640, 480))
    focal = settings.number("focal", 525.0, 0)
    settings.refuse_others()
    seen = width * height / focal, depth * height / focal
    if seen[0] + _SLACK < surface.width or seen[1] + _SLACK < surface.depth:
        findings.error(
            "E510",
            "the camera does not see the whole surface",
            settings.span("height"),
            f"it sees {_cm(seen[0])} x {_cm(seen[1])}",
            f"the surface is {_cm(surface.width)} x {_cm(surface.depth)}: "
            "raise the camera, or shorten `focal`",
        )
    return CameraSetup(height, width, depth, focal)


def _symbols(settings: Settings, findings: Findings) -> SymbolThresholds:
    symbols = SymbolThresholds(
        settings.length("link", 0.05),
        settings.length("small", 0.06),
        settings.length("medium", 0.12),
        settings.number("density", 0.14, 0, 1),
        settings.length("near", 0.20, zero=True),
        settings.length("traversal", 0.05),
    )
    settings.refuse_others()
    if symbols.medium <= symbols.small:
        findings.error(
            "E511",
            "`medium` must be above `small`",
            settings.span("medium"),
            help=f"an area up to {_cm(symbols.small)} long is small",
        )
    return symbols


def _dirt(
    section: Section | None, name: Name, surface: Surface, findings: Findings
) -> tuple[Group | Scattered, ...]:
    if section is None or not section.entries:
        if "dirt" not in findings.broken:
            findings.error(
                "E512",
                "there is no dirt to clean",
                section.name.span if section else name.span,
                help="add `dirt { group { count = 14  at = (0 cm, 0 cm)  radius = 2 cm } }`",
            )
        return ()
    readers: dict[str, Callable[[Section, Surface, Findings], Group | Scattered]] = {
        "group": _group,
        "scattered": _scattered,
    }
    dirt = []
    for entry in section.entries:
        if not isinstance(entry, Section):
            findings.unknown("E502", "key", entry.key.text, entry.key.span, readers, " in `dirt`")
        elif entry.name.text not in readers:
            findings.unknown("E501", "kind of dirt", entry.name.text, entry.name.span, readers)
        else:
            dirt.append(readers[entry.name.text](entry, surface, findings))
    return tuple(dirt)


def _group(section: Section, surface: Surface, findings: Findings) -> Group:
    settings = Settings(section.name, section.entries, findings)
    count = settings.whole("count", None, 1, MOST_LENTILS)
    centre = settings.point("at")
    radius = settings.length("radius", None)
    settings.refuse_others()
    if not _on_surface(centre, radius, surface):
        findings.error("E508", "this dirt lies off the surface", settings.span("at"), help=_extent(surface))
    return Group(count, centre, radius)


def _scattered(section: Section, surface: Surface, findings: Findings) -> Scattered:
    settings = Settings(section.name, section.entries, findings)
    count = settings.whole("count", None, 1, MOST_LENTILS)
    low, high = settings.point("from"), settings.point("to")
    settings.refuse_others()
    for key, corner in (("from", low), ("to", high)):
        if not _on_surface(corner, 0.0, surface):
            findings.error(
                "E508", "this dirt lies off the surface", settings.span(key), help=_extent(surface)
            )
    if low[0] >= high[0] or low[1] >= high[1]:
        findings.error("E511", "`to` must lie north-east of `from`", settings.span("to"))
    return Scattered(count, low, high)


def _on_surface(centre: tuple[float, float], radius: float, surface: Surface) -> bool:
    x, y = centre
    return abs(x) + radius <= surface.width / 2 + _SLACK and abs(y) + radius <= surface.depth / 2 + _SLACK


def _extent(surface: Surface) -> str:
    return (
        f"the surface reaches from -{_cm(surface.width / 2)} to {_cm(surface.width / 2)} in x "
        f"and from -{_cm(surface.depth / 2)} to {_cm(surface.depth / 2)} in y"
    )


def _cm(metres: float) -> str:
    return f"{metres * 100:.4g} cm"
