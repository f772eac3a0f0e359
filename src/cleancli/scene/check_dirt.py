"""The dirt of a scene: what kinds there are, their settings, and whether they lie on the surface."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from cleancli.language.diagnostics.sink import Findings
from cleancli.language.syntax import Name, Section
from cleancli.scene.kinds import SLACK, centimetres
from cleancli.scene.model import Dirt, Group, Ink, Scattered, Surface
from cleancli.scene.schema import DIRT
from cleancli.scene.settings import Settings

_MIDDLE = (0.0, 0.0)
"""Of the surface: stands for a place that is missing or wrong, which is told already."""


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
    dirt = []
    for entry in section.entries:
        if not isinstance(entry, Section):
            findings.unknown("E502", "key", entry.key.text, entry.key.span, DIRT, " in `dirt`")
        elif entry.name.text not in DIRT:
            findings.unknown("E501", "kind of dirt", entry.name.text, entry.name.span, DIRT)
        else:
            settings = Settings(entry.name.text, entry.name, entry.entries, findings)
            dirt.append(_READERS[entry.name.text](settings, surface, findings))
    return tuple(dirt)


def _group(settings: Settings, surface: Surface, findings: Findings) -> Group:
    centre, radius = settings["at"] or _MIDDLE, settings["radius"] or 0.0
    if not on_surface(centre, radius, surface):
        refuse_off("dirt", "at", settings, surface, findings)
    return Group(settings["count"], centre, radius, settings["of"], settings["colour"])


def _scattered(settings: Settings, surface: Surface, findings: Findings) -> Scattered:
    low, high = settings["from"] or _MIDDLE, settings["to"] or _MIDDLE
    for key, corner in (("from", low), ("to", high)):
        if not on_surface(corner, 0.0, surface):
            refuse_off("dirt", key, settings, surface, findings)
    if low[0] >= high[0] or low[1] >= high[1]:
        findings.error("E511", "`to` must lie north-east of `from`", settings.span("to"))
    return Scattered(settings["count"], low, high, settings["of"], settings["colour"])


def _ink(settings: Settings, surface: Surface, findings: Findings) -> Ink:
    ink = Ink(settings["along"] or (), settings["width"], settings["colour"])
    if not all(on_surface(point, ink.width / 2, surface) for point in ink.along):
        refuse_off("ink", "along", settings, surface, findings)
    return ink


_READERS: Mapping[str, Callable[[Settings, Surface, Findings], Dirt]] = {
    "group": _group,
    "scattered": _scattered,
    "ink": _ink,
}


def on_surface(centre: tuple[float, float], radius: float, surface: Surface) -> bool:
    """Whether what reaches so far from its middle, along x and along y, lies on the surface."""
    x, y = centre
    return abs(x) + radius <= surface.width / 2 + SLACK and abs(y) + radius <= surface.depth / 2 + SLACK


def refuse_off(what: str, key: str, settings: Settings, surface: Surface, findings: Findings) -> None:
    """Report something that lies off the surface, at the key that says where it lies (E508)."""
    x, y = centimetres(surface.width / 2), centimetres(surface.depth / 2)
    help = f"the surface reaches from -{x} to {x} in x and from -{y} to {y} in y"
    findings.error("E508", f"this {what} lies off the surface", settings.span(key), help=help)
