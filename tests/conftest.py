"""What all tests may rely on."""

from __future__ import annotations

import importlib.util
import os
import signal
from collections.abc import Iterator

import pytest

from cleancli.world.errors import MissingPhysics

# Whoever runs the tests in the background (`nohup`, or a shell without job control) has them ignore these,
# and so would all that they start; the program leaves an ignored signal ignored, as it should.
signal.signal(signal.SIGINT, signal.default_int_handler)
signal.signal(signal.SIGHUP, signal.SIG_DFL)

# What is told of slow work depends on the machine: tests of it set the seconds themselves.
os.environ["CLEANCLI_PROGRESS_AFTER"] = "inf"


if importlib.util.find_spec("pybullet") is None:
    # From Python 3.12 on it has no wheel. What needs it cannot be seen from a test's name: so a test that
    # fails, and in which the product has said that it is missing, is one that needs it.
    _said: list[MissingPhysics] = []
    _excused: list[BaseException] = []
    """Kept, because what a fixture raised is raised again for each test that asks for it."""

    _REASON = "needs pybullet, which is not installed"
    _tell = MissingPhysics.__init__

    def _note(self: MissingPhysics) -> None:
        _tell(self)
        _said.append(self)

    MissingPhysics.__init__ = _note  # type: ignore[method-assign]

    @pytest.hookimpl(tryfirst=True)
    def pytest_runtest_setup(item: pytest.Item) -> None:
        _said.clear()
        if item.get_closest_marker("needs_pybullet"):
            pytest.skip(_REASON)

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_makereport(item: pytest.Item, call: pytest.CallInfo[None]) -> Iterator[None]:
        report: pytest.TestReport = yield  # type: ignore[assignment]
        error = call.excinfo.value if report.failed and call.excinfo else None
        if error is not None and (_said or any(error is known for known in _excused)):
            _excused.append(error)
            path, line, _ = item.location
            report.outcome = "skipped"
            report.longrepr = (path, line or 0, f"Skipped: {_REASON}")
        return report  # type: ignore[return-value]
