"""The browser of this machine, for whatever looks at pages."""

from __future__ import annotations

import os
import shutil
from collections.abc import Iterator
from contextlib import contextmanager

import pytest
from playwright.sync_api import Browser, sync_playwright

NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "chrome")


def found() -> str | None:
    """Where a browser is on this machine."""
    return next(filter(None, map(shutil.which, NAMES)), None)


@contextmanager
def opened_browser() -> Iterator[Browser]:
    """A browser; where there is none the test is skipped, but not in CI, which has one."""
    path = found()
    if path is None:
        assert not os.environ.get("CI"), "CI installs a browser (.ci/run)"
        pytest.skip(f"no browser here, of {', '.join(NAMES)}: install one to have the pages tested in it")
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=path, args=["--no-sandbox"])
        yield browser
        browser.close()
