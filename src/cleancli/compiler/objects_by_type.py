"""Which objects each type has."""

from __future__ import annotations

from collections.abc import Sequence

from cleancli.language.model import Domain, Object


class ObjectsByType:
    """The names of the objects that each type has, in the order given; worked out for the types asked for."""

    def __init__(self, domain: Domain, objects: Sequence[Object]) -> None:
        self._parents = {type_.name: type_.parent for type_ in domain.types}
        self._given = objects
        self._names: dict[str, tuple[str, ...]] = {}
        self._sets: dict[str, frozenset[str]] = {}

    def __getitem__(self, type_name: str) -> tuple[str, ...]:
        if type_name not in self._names:
            below: dict[str, bool] = {}
            found = (each.name for each in self._given if self._is_below(each.type, type_name, below))
            self._names[type_name] = tuple(dict.fromkeys(found))
        return self._names[type_name]

    def names(self, type_name: str) -> frozenset[str]:
        """The same as a set."""
        if type_name not in self._sets:
            self._sets[type_name] = frozenset(self[type_name])
        return self._sets[type_name]

    def _is_below(self, type_name: str, ancestor: str, known: dict[str, bool]) -> bool:
        """Whether it is the ancestor or below it; `known` says so of the types on the ways that were gone."""
        way: list[str] = []
        here: str | None = type_name
        while here is not None and here != ancestor and here not in known:
            way.append(here)
            here = self._parents[here]
        found = here == ancestor or (here is not None and known[here])
        known |= dict.fromkeys(way, found)
        return found
