"""The transitive closure of a relation, as bits.

2,000 names that all reach each other take half a megabyte, and the time of their steps.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence


class Paths:
    """The transitive closure of `steps`, which lists for each name those that one step leads to."""

    def __init__(self, steps: Mapping[str, Sequence[str]]) -> None:
        self._reached: dict[str, int] = {}
        names = {*steps, *(target for targets in steps.values() for target in targets)}
        self._bit = {name: 1 << number for number, name in enumerate(names)}
        for component in _components(steps):
            found = 0
            for target in (target for name in component for target in steps.get(name, ())):
                # Targets outside the component belong to one that was found before.
                found |= self._bit[target] | self._reached.get(target, 0)
            self._reached |= dict.fromkeys(component, found)

    def lead(self, start: str, goal: str) -> bool:
        """Whether one or more steps lead from start to goal."""
        return bool(self._reached.get(start, 0) & self._bit.get(goal, 0))


def _components(steps: Mapping[str, Sequence[str]]) -> Iterator[list[str]]:
    """The strongly connected components, each after all that it leads to (Kosaraju and Sharir)."""
    taken: set[str] = set()
    for name in reversed(_finished(_reversed(steps))):
        if name not in taken:
            yield _reachable(name, steps, taken)


def _reversed(steps: Mapping[str, Sequence[str]]) -> dict[str, list[str]]:
    """For each name those from which one step leads to it."""
    sources: dict[str, list[str]] = {name: [] for name in steps}
    for source, targets in steps.items():
        for target in targets:
            sources.setdefault(target, []).append(source)
    return sources


def _finished(steps: Mapping[str, Sequence[str]]) -> list[str]:
    """The names in the order in which a depth-first search has done with them."""
    met: set[str] = set()
    finished: list[str] = []
    for root in steps:
        if root not in met:
            finished += _finished_from(root, steps, met)
    return finished


def _finished_from(root: str, steps: Mapping[str, Sequence[str]], met: set[str]) -> Iterator[str]:
    """Those that are found from `root` and were not `met` before; they are met then."""
    met.add(root)
    work = [(root, iter(steps[root]))]
    while work:
        name, targets = work[-1]
        target = next((target for target in targets if target not in met), None)
        if target is None:
            yield name
            work.pop()
        else:
            met.add(target)
            work.append((target, iter(steps[target])))


def _reachable(start: str, steps: Mapping[str, Sequence[str]], taken: set[str]) -> list[str]:
    """The start and all names that steps lead to, but for those that are `taken`; they are then taken too."""
    taken.add(start)
    found = [start]
    for name in found:
        new = [target for target in dict.fromkeys(steps.get(name, ())) if target not in taken]
        taken.update(new)
        found += new
    return found
