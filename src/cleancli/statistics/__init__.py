"""Statistics of runs, as pure functions of arrays."""
