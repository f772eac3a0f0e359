"""Short names for everyday tasks: `nox -s tests`, and so on. Each runs in an environment of its own."""

from __future__ import annotations

import nox

nox.options.sessions = ["lint", "types", "tests"]


def _installed(session: nox.Session) -> None:
    session.install("-e", ".[test]")


@nox.session
def tests(session: nox.Session) -> None:
    """All tests; words behind `--` go to pytest."""
    _installed(session)
    session.run("pytest", *session.posargs)


@nox.session
def lint(session: nox.Session) -> None:
    """Style and format."""
    session.install("ruff>=0.6")
    session.run("ruff", "check")
    session.run("ruff", "format", "--check")


@nox.session
def types(session: nox.Session) -> None:
    """Types of the sources, the tests and the benchmarks."""
    _installed(session)
    session.run("mypy")


@nox.session
def docs(session: nox.Session) -> None:
    """Every command of the documents, and the source of every number."""
    _installed(session)
    session.run("pytest", "tests/test_docs.py")


@nox.session
def site(session: nox.Session) -> None:
    """The documentation as a site, in build/site; warnings and dead links are errors."""
    session.install("-e", ".[docs]")
    session.run("python", "-m", "sphinx", "-W", "--keep-going", "docs", "build/site")


@nox.session
def bench_quick(session: nox.Session) -> None:
    """A little of each benchmark."""
    _installed(session)
    session.run("pytest", "tests/test_benchmarks.py")
