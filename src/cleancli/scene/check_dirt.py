"""The dirt of a scene: what kinds there are, their settings, and whether they lie on the surface."""

from __future__ import annotations

from collections.abc import Callable

from cleancli.language.diagnostics.sink import Findings
from cleancli.language.syntax import Name, Section
from cleancli.scene.model import Dirt, Group, Ink, Scattered, Surface
from cleancli.scene.settings import SLACK, Settings, centimetres

PARTICLES = ("lentils", "rice", "peas")
MOST_PARTICLES = 500
"""Of one group: far more than any table of the paper has (40), few enough to simulate."""
MOST_POINTS = 200
"""Of one line of ink."""


def check_dirt(section: Section | None, name: Name, surface: Surface, findings: Findings) -> tuple[Dirt, ...]:
    """What a `dirt` block puts on the surface; `name` is where a scene without one is refused (E512)."""
    if section is None or not section.entries:
        if "dirt" not in findings.broken:
            findings.error(
                "E512",
                "there is no dirt to clean",
                section.name.span if section else name.span,
                help="add `dirt { group { count = 14  at = (0 cm, 0 cm)  radius = 2 cm } }`",
            )
        return ()
    readers: dict[str, Callable[[Section, Surface, Findings], Dirt]] = {
        "group": _group,
        "scattered": _scattered,
        "ink": _ink,
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
    count = settings.whole("count", None, 1, MOST_PARTICLES)
    of = settings.word("of", "lentils", PARTICLES, "kind of particle")
    centre = settings.point("at")
    radius = settings.length("radius", None)
    colour = settings.own_colour("colour")
    settings.refuse_others()
    if not _on_surface(centre, radius, surface):
        findings.error("E508", "this dirt lies off the surface", settings.span("at"), help=_extent(surface))
    return Group(count, centre, radius, of, colour)


def _scattered(section: Section, surface: Surface, findings: Findings) -> Scattered:
    settings = Settings(section.name, section.entries, findings)
    count = settings.whole("count", None, 1, MOST_PARTICLES)
    of = settings.word("of", "lentils", PARTICLES, "kind of particle")
    low, high = settings.point("from"), settings.point("to")
    colour = settings.own_colour("colour")
    settings.refuse_others()
    for key, corner in (("from", low), ("to", high)):
        if not _on_surface(corner, 0.0, surface):
            findings.error(
                "E508", "this dirt lies off the surface", settings.span(key), help=_extent(surface)
            )
    if low[0] >= high[0] or low[1] >= high[1]:
        findings.error("E511", "`to` must lie north-east of `from`", settings.span("to"))
    return Scattered(count, low, high, of, colour)


def _ink(section: Section, surface: Surface, findings: Findings) -> Ink:
    settings = Settings(section.name, section.entries, findings)
    ink = Ink(
        settings.points("along", MOST_POINTS),
        settings.length("width", 0.008, least=0.001, most=1.0),
        settings.own_colour("colour"),
    )
    settings.refuse_others()
    if not all(_on_surface(point, ink.width / 2, surface) for point in ink.along):
        findings.error("E508", "this ink lies off the surface", settings.span("along"), help=_extent(surface))
    return ink


def _on_surface(centre: tuple[float, float], radius: float, surface: Surface) -> bool:
    x, y = centre
    return abs(x) + radius <= surface.width / 2 + SLACK and abs(y) + radius <= surface.depth / 2 + SLACK


def _extent(surface: Surface) -> str:
    x, y = centimetres(surface.width / 2), centimetres(surface.depth / 2)
    return f"the surface reaches from -{x} to {x} in x and from -{y} to {y} in y"
