"""Texts to ask about, with marks for the places that tests mean."""

from __future__ import annotations

from pathlib import Path

from cleancli.editor.library import Document, Library, document
from cleancli.language.diagnostics.diagnostic import Source

ROOT = Path(__file__).parent.parent.parent
KINDS = ("domains", "problems", "studies")
SHIPPED = sorted(path for kind in KINDS for path in (ROOT / kind).glob("*.nid"))

DOMAIN = """\
# Tables and what lies on them.

domain tables {
  types      { place; area - place; container - place }
  constants  { bin - container }
  # Facts about areas.
  predicates {
    dirt(?a - area)                  # a dirty area 🧽 on the surface
    # two areas
    # side by side
    near(?a ?b - area) [symmetric]
    traversal(?a ?b ?m - place)
  }
  functions  { size(?a - area): small < medium < big  weight(?a - area): small < large }
  derived    { dirty_areas := count ?a - area: dirt(?a) }
  actions    { push(?a - area) [duration = 9 s]  join(?a ?b - area) }

  rule push_small: push(?x) {        # the easy one
    when dirt(?x), size(?x) = small
    then 0.65 [prior 0.6, seen 14]: not dirt(?x), forall ?m - area: traversal(?x, bin, ?m) => not dirt(?m)
         0.1: size(?x) := medium
         rest: noise
  }
  rule join_two: join(?a, ?b) {
    when dirt(?a), dirt(?b), near(?a, ?b), weight(?a) = small, ?a != ?b
    then 0.9: not dirt(?a), size(?b) := big
         0.1: nothing
  }
  reward  { decrease(dirty_areas) }
}
"""

PROBLEM = """\
problem two {
  domain  = tables
  objects { a1 a2 - area }
  init    {
    dirt(a1), dirt(a2), near(a1, a2), traversal(a1, bin, a2)
    size(a1) = small, size(a2) = big, weight(a1) = small, weight(a2) = large
  }
  horizon = 1 + dirty_areas
}
"""

SCENE = """\
scene little {
  domain = tables
  rag    { width = 10 cm }
  dirt   { group { count = 3  at = (0 cm, 0 cm)  radius = 2 cm } }
}
"""

FOLDER = Path("/somewhere/table files")
OPEN = Library(
    {str(FOLDER / "tables.nid"): DOMAIN, str(FOLDER / "two.nid"): PROBLEM, str(FOLDER / "little.nid"): SCENE}
)
"""A library of texts that are in no folder: nothing is read from the disk."""


def opened(name: str) -> Document:
    """One of the open texts."""
    found = OPEN.document(FOLDER / name)
    assert found is not None
    return found


def marked(name: str, text: str) -> tuple[Document, int, Library]:
    """A text with one `|` for the place that is meant: the document without it, the offset, the library."""
    offset = text.index("|")
    path = str(FOLDER / name)
    whole = text[:offset] + text[offset + 1 :]
    return document(Source(path, whole)), offset, Library({**OPEN.open, path: whole})


def at(name: str, mark: str) -> tuple[Document, int]:
    """A place in an open text: that of the `|` in a piece of it that occurs once or first."""
    asked = opened(name)
    return asked, asked.source.text.index(mark.replace("|", "")) + mark.index("|")
