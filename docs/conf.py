"""The site of the documentation: `python -m sphinx docs build/site`, with the extra `docs`.

Pages are plain Markdown that reads well wherever the repository is browsed. What a site needs beside them
stands here: the order of pages, and how `.nid` texts are coloured.
"""

from __future__ import annotations

from typing import ClassVar

from pygments.lexer import RegexLexer, bygroups, words
from pygments.token import Comment, Keyword, Name, Number, Operator, Punctuation, String, Whitespace
from sphinx.application import Sphinx

from cleancli.language.diagnostics.sink import RESERVED

project = "cleancli"
author = "The cleancli authors"
project_copyright = author
extensions = ["myst_parser"]
highlight_language = "none"
html_theme = "furo"
html_title = project
html_copy_source = False
html_show_sphinx = False
myst_heading_anchors = (
    4  # made of headings as hosts of git repositories make them, so links hold in both places
)

NAVIGATION = {
    "index": {
        "First steps": "tutorial gallery comparison",
        "Guides": "planning simulation execution learning comparing-rules experiments report editors",
        "Robots and agents of your own": "your_own_robot protocol cell recording real_tables gym",
        "Reference": "language from-pddl diagnostics commands exit-codes python runs",
        "How it works": "planners perception world physics statistics",
        "Behind it": "measurements/index decisions/index tests language-tests",
    },
    "measurements/index": {
        "": "results planning execution physics perception learning world studies language"
    },
    "decisions/index": {"": "0*"},
}
"""By page: the pages below it in order, by the heading above them in the navigation."""


class NidLexer(RegexLexer):
    """Colours of domains, problems, scenes and studies, by signs and a few words."""

    name = "nid"
    aliases: ClassVar[list[str]] = ["nid"]
    tokens: ClassVar = {
        "root": [
            (r"#.*$", Comment.Single),
            (r"\s+", Whitespace),
            (r'"[^"\n]*"', String),
            (r"\?\w+", Name.Variable),
            (r"\d+(\.\d+)?(/\d+)?", Number),
            (words(sorted(RESERVED), suffix=r"\b"), Keyword),
            (r"([a-z]+)(\s+)(\w+)(?=(:.*)?\s*\{)", bygroups(Keyword.Declaration, Whitespace, Name.Class)),
            (r"[a-z]+(?=\s*\{)", Keyword.Declaration),
            (r"\w+(?=\()", Name.Function),
            (r"\w+", Name),
            (r"[:+\-]?=>?|[<>!]=?|[*/+-]", Operator),
            (r"[{}()\[\],:;.°%]", Punctuation),
        ]
    }


def with_navigation(_: Sphinx, page: str, source: list[str]) -> None:
    """Put a page's navigation at its end: for the menu alone, unless it is a pattern, which no page lists."""
    for heading, pages in NAVIGATION.get(page, {}).items():
        shown = ":titlesonly:" if "*" in pages else ":hidden:"
        options = [":glob:", shown, *([f":caption: {heading}"] if heading else [])]
        source[0] += "\n".join(["\n\n```{toctree}", *options, "", *pages.split(), "```", ""])


def unbroken(_: Sphinx, __: str, source: list[str]) -> None:
    """Keep a value and its error on one line of a table's cell; tables scroll where they are too wide."""
    source[0] = source[0].replace(" ± ", "\N{NO-BREAK SPACE}±\N{NO-BREAK SPACE}")


def setup(app: Sphinx) -> None:
    """Called by Sphinx."""
    app.add_lexer("nid", NidLexer)
    app.connect("source-read", unbroken)
    app.connect("source-read", with_navigation)
