"""Imported by the marked copy of the sources: which blocks were run. A process that ends tells its parent's
test, by a file in the folder that MUTATION_DUMPS names."""

from __future__ import annotations

import atexit
import json
import os
from pathlib import Path

HITS: set[int] = set()
hit = HITS.add


def _dump() -> None:
    folder = os.environ.get("MUTATION_DUMPS")
    if folder and HITS:
        partial = Path(folder) / f"{os.getpid()}.part"
        partial.write_text(json.dumps(sorted(HITS)))
        partial.rename(partial.with_suffix(".json"))


if "MUTATION_JOB_PROCESS" not in os.environ or os.environ["MUTATION_JOB_PROCESS"] != str(os.getpid()):
    atexit.register(_dump)
