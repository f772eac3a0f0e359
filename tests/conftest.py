"""What all tests may rely on."""

from __future__ import annotations

import signal

# Whoever runs the tests in the background (`nohup`, or a shell without job control) has them ignore these,
# and so would all that they start; the program leaves an ignored signal ignored, as it should.
signal.signal(signal.SIGINT, signal.default_int_handler)
signal.signal(signal.SIGHUP, signal.SIG_DFL)
