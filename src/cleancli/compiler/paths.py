"""The transitive closure of a relation, as bits.

2,000 names that all reach each other take half a megabyte, and the time of their steps.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence


class Paths:
    """The transitive closure of `steps`, which lists for each name those that one step leads to."""

    def __init__(self, steps: Mapping[str, Sequence[str]]) -> None:
        self._reached: dict[str, int] = {}
        names = sorted({*steps, *(target for targets in steps.values() for target in targets)})
        self._bit = {name: 1 << number for number, name in enumerate(names)}
        for component in _components(steps):
            inner, found = 0, 0
            for name in component:
                inner |= self._bit[name]
            for target in (target for name in component for target in steps.get(name, ())):
                # Targets outside the component belong to one that was found before.
                found |= self._bit[target] | self._reached.get(target, 0)
            is_cycle = len(component) > 1 or bool(found & inner)
            found |= inner if is_cycle else 0
            self._reached |= dict.fromkeys(component, found)

    def lead(self, start: str, goal: str) -> bool:
        """Whether one or more steps lead from start to goal."""
        return bool(self._reached.get(start, 0) & self._bit.get(goal, 0))


def _components(steps: Mapping[str, Sequence[str]]) -> Iterator[list[str]]:
    """The strongly connected components, each after all that it leads to (Tarjan, without recursion)."""
    order: dict[str, int] = {}
    low: dict[str, int] = {}
    stack: dict[str, None] = {}
    for root in sorted(steps):
        work = [root] if root not in order else []
        targets = {root: iter(steps[root])}
        while work:
            name = work[-1]
            if name not in order:
                order[name] = low[name] = len(order)
                stack[name] = None
            target = next(targets[name], None)
            if target is None:
                work.pop()
                if work:
                    low[work[-1]] = min(low[work[-1]], low[name])
                if low[name] == order[name]:
                    yield list(_taken_down_to(name, stack))
            elif target not in order:
                work.append(target)
                targets[target] = iter(steps.get(target, ()))
            elif target in stack:
                low[name] = min(low[name], order[target])


def _taken_down_to(name: str, stack: dict[str, None]) -> Iterator[str]:
    taken = ""
    while taken != name:
        taken = stack.popitem()[0]
        yield taken
