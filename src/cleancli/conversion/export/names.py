"""Names for files of other languages: those of the .nid file where they can stay."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping

from cleancli.language.model import Symbol, Value


class Naming:
    """Gives each name of one kind a name in another language, none twice.

    `reserved` has that language's words; letter case makes no difference to it where `folded` says so.
    """

    def __init__(self, reserved: Collection[str], *, folded: bool) -> None:
        self._folded = folded
        self._taken = {self._key(word) for word in reserved}
        self._given: dict[str, str] = {}

    def of(self, name: str) -> str:
        """What something is called, now and each time."""
        if name not in self._given:
            self._given[name] = self.fresh(name)
        return self._given[name]

    def fresh(self, wanted: str) -> str:
        """The wanted name, with a number behind it where it is taken. It begins with a letter."""
        name = wanted if wanted[0].isalpha() else f"n{wanted}"
        found, number = name, 2
        while self._key(found) in self._taken:
            found, number = f"{name}_{number}", number + 1
        self._taken.add(self._key(found))
        return found

    @property
    def changed(self) -> Mapping[str, str]:
        """The names that could not stay, with what they have become."""
        return {old: new for old, new in self._given.items() if old != new}

    def _key(self, name: str) -> str:
        return name.lower() if self._folded else name


class Predicates:
    """What symbols are called, and the predicates that stand for the values of functions; `joined` makes a
    name of a function's and a value's. `asked` has the functions of whose values a predicate was wanted."""

    def __init__(self, naming: Naming, joined: Callable[[str, str], str]) -> None:
        self.naming = naming
        self.asked: set[str] = set()
        self._joined = joined
        self._values: dict[tuple[str, Value], str] = {}

    def of(self, symbol: str, value: Value | None = None) -> str:
        """The predicate of a symbol, or of one value of a function."""
        if value is None:
            return self.naming.of(symbol)
        self.asked.add(symbol)
        return self._named(symbol, value)

    def claim(self, symbols: Iterable[Symbol]) -> None:
        """Give the values of functions their names in this order, whatever is asked for first."""
        for symbol in symbols:
            for value in () if symbol.is_predicate else symbol.values:
                self._named(symbol.name, value)

    def _named(self, symbol: str, value: Value) -> str:
        if (symbol, value) not in self._values:
            shown = f"minus_{-value}" if isinstance(value, int) and value < 0 else str(value)
            self._values[symbol, value] = self.naming.fresh(self._joined(symbol, shown))
        return self._values[symbol, value]
