"""Reads the settings of one scene section by key, each with its unit and range, and reports what is wrong."""

from __future__ import annotations

import math
from collections.abc import Iterable

from cleancli.language.diagnostics.diagnostic import Span
from cleancli.language.diagnostics.sink import Findings
from cleancli.language.syntax import (
    Call,
    ImageSize,
    Name,
    Pair,
    Points,
    Quantity,
    Quoted,
    Section,
    Setting,
    SettingValue,
    Word,
)

SLACK = 1e-9
"""Metres by which sums of rounded lengths may miss a limit they equal."""

MOST_PIXELS = 1920 * 1080
"""Of an image. Measured: a look of three frames computes for 7 s, and takes less than half a GB."""

LONGEST = 10.0
"""Metres of whatever is not limited otherwise: the world and perception take memory and time by lengths."""

_PER_METRE = {"m": 1, "cm": 100, "mm": 1000}
_PER_RADIAN = {"rad": 1.0, "deg": 180 / math.pi}


class Settings:
    """The settings among `entries`. Each reader returns the default where the key is missing or wrong."""

    def __init__(self, name: Name, entries: Iterable[Setting | Section], findings: Findings) -> None:
        self._name = name
        self._findings = findings
        self._settings: dict[str, Setting] = {}
        self._asked: set[str] = set()
        for entry in entries:
            if not isinstance(entry, Setting):
                continue
            if entry.key.text in self._settings:
                line = findings.line(self._settings[entry.key.text].span)
                findings.error(
                    "E216",
                    f"a second `{entry.key.text}`",
                    entry.key.span,
                    help=f"the first stands in {line}",
                )
            else:
                self._settings[entry.key.text] = entry

    def span(self, key: str) -> Span:
        """The place of a value, or of the section's name where the value is a default."""
        setting = self._settings.get(key)
        return self._name.span if setting is None else setting.value.span

    def length(
        self,
        key: str,
        default: float | None,
        zero: bool = False,
        negative: bool = False,
        least: float = 0.0,
        most: float = LONGEST,
    ) -> float:
        """A length in metres, above zero unless said otherwise, and from `least` to `most`."""
        value = self._take(key, default)
        if value is None:
            return default or 0.0
        metres = self._metres(value)
        if metres is not None and not negative and (metres < 0 or (metres == 0 and not zero)):
            self._range(value, "must not be negative" if zero else "must be above 0")
            metres = None
        if metres is not None and not least - SLACK <= abs(metres) <= most + SLACK:
            self._range(
                value, f"must be {f'from {_length(least)} to' if least else 'at most'} {_length(most)}"
            )
            metres = None
        return (default or 0.0) if metres is None else metres

    def number(
        self, key: str, default: float, low: float, high: float = math.inf, including: bool = False
    ) -> float:
        """A plain number from `low`, which is excluded unless `including` says otherwise, to `high`."""
        value = self._take(key, default)
        if value is None:
            return default
        number = self._plain(value)
        if number is not None and not (low < number <= high or (including and number == low)):
            top = "" if high == math.inf else f" and at most {high:g}"
            self._range(value, f"must be {'at least' if including else 'above'} {low:g}{top}")
            number = None
        return default if number is None else number

    def whole(self, key: str, default: int | None, low: int, high: int) -> int:
        """A whole number from `low` to `high`, both included."""
        value = self._take(key, default)
        if value is None:
            return default if default is not None else low
        number = self._plain(value)
        if number is not None and (number != int(number) or not low <= number <= high):
            self._range(value, f"must be a whole number from {low} to {high}")
            number = None
        return (low if default is None else default) if number is None else int(number)

    def word(
        self, key: str, default: str, choices: Iterable[str] | None = None, what: str | None = None
    ) -> str:
        """A name, one of `choices` where they are given; `what` they are, if the key does not say it."""
        value = self._take(key, default)
        if value is None:
            return default
        if not isinstance(value, Word):
            self._wrong(value, "a name")
            return default
        if choices is not None and value.text not in choices:
            self._findings.unknown("E506", what or key, value.text, value.span, choices)
            return default
        return value.text

    def point(self, key: str, default: tuple[float, float] | None = None) -> tuple[float, float]:
        """A point `(x, y)` in metres, required where there is no default."""
        value = self._take(key, default)
        if value is None:
            return default or (0.0, 0.0)
        if not isinstance(value, Pair):
            self._wrong(value, "a point such as `(10 cm, -5 cm)`")
            return 0.0, 0.0
        return self._coordinate(value.x), self._coordinate(value.y)

    def points(self, key: str, most: int) -> tuple[tuple[float, float], ...]:
        """One point `(x, y)` or several `((x, y), ...)`, required, in metres; `most` at most."""
        value = self._take(key, None)
        if value is None:
            return ()
        if not isinstance(value, Pair | Points):
            self._wrong(value, "points such as `((0 cm, 0 cm), (10 cm, 5 cm))`")
            return ()
        pairs = value.points if isinstance(value, Points) else (value,)
        if len(pairs) > most:
            self._range(value, f"must have at most {most} points")
        return tuple((self._coordinate(pair.x), self._coordinate(pair.y)) for pair in pairs)

    def angle(self, key: str, default: float, low: float, high: float) -> float:
        """An angle in radians, from `low` to `high` degrees."""
        value = self._take(key, default)
        radians = default if value is None else self._radians(value, low, high)
        return default if radians is None else radians

    def angles(
        self, key: str, default: tuple[float, float], *bounds: tuple[float, float]
    ) -> tuple[float, float]:
        """Two angles `(a, b)` in radians, each from its own lower to its own upper bound in degrees."""
        value = self._take(key, default)
        if value is None:
            return default
        if not isinstance(value, Pair):
            self._wrong(value, "two angles such as `(2 deg, 0 deg)`")
            return default
        (first, second) = bounds
        read = self._radians(value.x, *first), self._radians(value.y, *second)
        return default if read[0] is None or read[1] is None else (read[0], read[1])

    def path(self, key: str) -> str | None:
        """A path in quotation marks, as it is written; None where the key is missing."""
        value = self._take(key, "")
        if value is not None and not isinstance(value, Quoted):
            self._wrong(value, 'a path in quotation marks, such as `"table.json"`')
        return value.text if isinstance(value, Quoted) else None

    def own_colour(self, key: str) -> tuple[int, int, int] | None:
        """As `colour`; None where the key is missing."""
        self._asked.add(key)
        return self.colour(key, (0, 0, 0)) if key in self._settings else None

    def colour(self, key: str, default: tuple[int, int, int]) -> tuple[int, int, int]:
        """`rgb(red, green, blue)`, each a whole number from 0 to 255."""
        value = self._take(key, default)
        if value is None:
            return default
        if not isinstance(value, Call) or value.name.text != "rgb" or len(value.arguments) != 3:
            self._wrong(value, "a colour such as `rgb(205, 198, 184)`")
            return default
        for argument in value.arguments:
            if not argument.is_whole or argument.value > 255:
                self._findings.error("E505", "a colour has whole numbers from 0 to 255", argument.span)
        red, green, blue = (int(argument.value) for argument in value.arguments)
        return red, green, blue

    def image(self, key: str, default: tuple[int, int]) -> tuple[int, int]:
        """`width x height` in pixels, each from 16 to 4096, and not more than MOST_PIXELS in all."""
        value = self._take(key, default)
        if value is None:
            return default
        if not isinstance(value, ImageSize):
            self._wrong(value, "a size such as `640 x 480`")
            return default
        for side in (value.width, value.height):
            if not side.is_whole or not 16 <= side.value <= 4096:
                self._findings.error("E505", "an image has 16 to 4096 pixels a side", side.span)
        width, height = value.width.value, value.height.value
        if max(width, height) <= 4096 and width * height > MOST_PIXELS:
            self._range(value, "must have at most as many pixels as 1920 x 1080")
        return int(width), int(height)

    def refuse_others(self) -> None:
        """Report the keys that nobody asked for (E502)."""
        for key, setting in self._settings.items():
            if key not in self._asked:
                self._findings.unknown(
                    "E502", "key", key, setting.key.span, self._asked, f" in `{self._name.text}`"
                )

    def _take(self, key: str, default: object) -> SettingValue | None:
        self._asked.add(key)
        setting = self._settings.get(key)
        if setting is None and default is None:
            self._findings.error("E513", f"`{self._name.text}` needs `{key}`", self._name.span)
        return None if setting is None else setting.value

    def _metres(self, value: SettingValue) -> float | None:
        if not isinstance(value, Quantity):
            self._wrong(value, "a length such as `12 cm`")
            return None
        if value.unit is None and value.value == 0:
            return 0.0
        if value.unit is None or value.unit not in _PER_METRE:
            what = "no unit" if value.unit is None else f"the unit `{value.unit}`"
            self._findings.error(
                "E503", f"a length with {what}", value.span, help="lengths are in m, cm or mm"
            )
            return None
        # Dividing the exact number gives the float nearest to what is written: 35 mm is 0.035.
        return float(value.value / _PER_METRE[value.unit])

    def _coordinate(self, value: SettingValue) -> float:
        metres = self._metres(value) or 0.0
        if abs(metres) > LONGEST + SLACK:
            self._range(value, f"must be at most {_length(LONGEST)} from the middle")
            return 0.0
        return metres

    def _radians(self, value: SettingValue, low: float, high: float) -> float | None:
        if not isinstance(value, Quantity):
            self._wrong(value, "an angle such as `5 deg`")
            return None
        if value.unit not in _PER_RADIAN and (value.unit is not None or value.value != 0):
            what = "no unit" if value.unit is None else f"the unit `{value.unit}`"
            self._findings.error("E503", f"an angle with {what}", value.span, help="angles are in deg or rad")
            return None
        radians = float(value.value) / _PER_RADIAN[value.unit or "rad"]
        if not low - 1e-9 <= math.degrees(radians) <= high + 1e-9:
            self._range(value, f"must be from {low:g} to {high:g} deg")
            return None
        return radians

    def _plain(self, value: SettingValue) -> float | None:
        if not isinstance(value, Quantity):
            self._wrong(value, "a number")
            return None
        if value.unit is not None:
            self._findings.error(
                "E503", "this number has no unit", value.span, help=f"leave out `{value.unit}`"
            )
            return None
        return float(value.value)

    def _wrong(self, value: SettingValue, wanted: str) -> None:
        self._findings.error("E504", f"expected {wanted}", value.span)

    def _range(self, value: SettingValue, condition: str) -> None:
        self._findings.error("E505", f"this {condition}", value.span)


def _length(metres: float) -> str:
    """A limit as it is written in a scene."""
    return next(f"{metres * n:g} {unit}" for unit, n in _PER_METRE.items() if metres * n >= 1 or n == 1000)


def centimetres(metres: float) -> str:
    """A length for a message."""
    return f"{metres * 100:.4g} cm"
