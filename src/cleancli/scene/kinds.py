"""The kinds of values that settings of a scene have: how each is read, within its range, and written."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, ClassVar, Protocol

from cleancli.language.diagnostics.diagnostic import Span
from cleancli.language.diagnostics.sink import Findings
from cleancli.language.printing.printer import print_float
from cleancli.language.syntax import Call, ImageSize, Pair, Points, Quantity, Quoted, SettingValue, Word
from cleancli.scene.address import Address, address_of

SLACK = 1e-9
"""Metres by which sums of rounded lengths may miss a limit they equal."""

MOST_PIXELS = 1920 * 1080
"""Of an image. Measured: a look of three frames computes for 7 s, and takes less than half a GB."""

LONGEST = 10.0
"""Metres of whatever is not limited otherwise: the world and perception take memory and time by lengths."""

_PER_METRE = {"m": 1, "cm": 100, "mm": 1000}
_PER_RADIAN = {"rad": 1.0, "deg": 180 / math.pi}
LENGTH_UNITS = ("cm", "mm", "m")
ANGLE_UNITS = ("deg", "rad")


class Kind(Protocol):
    """What a setting's value may be; `units` are what its numbers may be followed by."""

    units: ClassVar[tuple[str, ...]]

    def read(self, value: SettingValue, report: Report) -> Any:
        """The value, lengths in metres and angles in radians; None, after a report, for what is none."""

    def write(self, value: Any) -> str:
        """The value as a scene says it."""


@dataclass(frozen=True, slots=True)
class Report:
    """Where mistakes of one value go."""

    findings: Findings
    key: str

    def wrong(self, value: SettingValue, wanted: str) -> None:
        """Report a value of another kind (E504)."""
        self.findings.error("E504", f"expected {wanted}", value.span)

    def range(self, span: Span, condition: str) -> None:
        """Report a value beyond its range (E505)."""
        self.findings.error("E505", condition, span)

    def unit(self, what: str, value: Quantity, help: str) -> None:
        """Report a unit that is wrong or missing (E503)."""
        unit = "no unit" if value.unit is None else f"the unit `{value.unit}`"
        self.findings.error("E503", f"{what} with {unit}", value.span, help=help)


@dataclass(frozen=True, slots=True)
class Length:
    """Metres from `least`, or above 0, to `most`; 0 and lengths below it where these are allowed."""

    units: ClassVar[tuple[str, ...]] = LENGTH_UNITS
    least: float = 0.0
    most: float = LONGEST
    zero: bool = False
    negative: bool = False

    def read(self, value: SettingValue, report: Report) -> float | None:
        metres = _metres(value, report)
        if metres is None:
            return None
        if not self.negative and (metres < 0 or (metres == 0 and not self.zero)):
            report.range(value.span, "this must not be negative" if self.zero else "this must be above 0")
            return None
        if not self.least - SLACK <= abs(metres) <= self.most + SLACK:
            start = f"from {_length(self.least)} to" if self.least else "at most"
            report.range(value.span, f"this must be {start} {_length(self.most)}")
            return None
        return metres

    def write(self, value: float) -> str:
        return _m(value)


@dataclass(frozen=True, slots=True)
class Number:
    """A number without a unit from `low`, which is excluded unless `including` says otherwise, to `high`."""

    units: ClassVar[tuple[str, ...]] = ()
    low: float
    high: float = math.inf
    including: bool = False

    def read(self, value: SettingValue, report: Report) -> float | None:
        number = _number(value, report)
        if number is None or self.low < number <= self.high or (self.including and number == self.low):
            return number
        top = "" if self.high == math.inf else f" and at most {self.high:g}"
        bottom = "at least" if self.including else "above"
        report.range(value.span, f"this must be {bottom} {self.low:g}{top}")
        return None

    def write(self, value: float) -> str:
        return print_float(value)


@dataclass(frozen=True, slots=True)
class Whole:
    """A whole number from `low` to `high`, both included."""

    units: ClassVar[tuple[str, ...]] = ()
    low: int
    high: int

    def read(self, value: SettingValue, report: Report) -> int | None:
        number = _number(value, report)
        if number is None:
            return None
        if number != int(number) or not self.low <= number <= self.high:
            report.range(value.span, f"this must be a whole number from {self.low} to {self.high}")
            return None
        return int(number)

    def write(self, value: int) -> str:
        return str(value)


@dataclass(frozen=True, slots=True)
class Choice:
    """A name, one of some where they are known; `what` they are, if the key does not say it."""

    units: ClassVar[tuple[str, ...]] = ()
    choices: tuple[str, ...] | None = None
    what: str | None = None

    def read(self, value: SettingValue, report: Report) -> str | None:
        if not isinstance(value, Word):
            report.wrong(value, "a name")
            return None
        if self.choices is not None and value.text not in self.choices:
            what = self.what or report.key
            most = len(self.choices)  # a setting has these values and no others
            report.findings.unknown("E506", what, value.text, value.span, self.choices, most=most)
            return None
        return value.text

    def write(self, value: str) -> str:
        return value


@dataclass(frozen=True, slots=True)
class Point:
    """A point `(x, y)` in metres."""

    units: ClassVar[tuple[str, ...]] = LENGTH_UNITS

    def read(self, value: SettingValue, report: Report) -> tuple[float, float] | None:
        if not isinstance(value, Pair):
            report.wrong(value, "a point such as `(10 cm, -5 cm)`")
            return None
        return _point(value, report)

    def write(self, value: tuple[float, float]) -> str:
        return f"({_m(value[0])}, {_m(value[1])})"


@dataclass(frozen=True, slots=True)
class Line:
    """One point `(x, y)` or several `((x, y), ...)` in metres; `most` at most."""

    units: ClassVar[tuple[str, ...]] = LENGTH_UNITS
    most: int

    def read(self, value: SettingValue, report: Report) -> tuple[tuple[float, float], ...] | None:
        if not isinstance(value, Pair | Points):
            report.wrong(value, "points such as `((0 cm, 0 cm), (10 cm, 5 cm))`")
            return None
        pairs = value.points if isinstance(value, Points) else (value,)
        if len(pairs) > self.most:
            report.range(value.span, f"this must have at most {self.most} points")
        return tuple(_point(pair, report) for pair in pairs)

    def write(self, value: tuple[tuple[float, float], ...]) -> str:
        return f"({', '.join(map(Point().write, value))})"


@dataclass(frozen=True, slots=True)
class Angle:
    """Radians, from `low` to `high` degrees."""

    units: ClassVar[tuple[str, ...]] = ANGLE_UNITS
    low: float
    high: float

    def read(self, value: SettingValue, report: Report) -> float | None:
        if not isinstance(value, Quantity):
            report.wrong(value, "an angle such as `5 deg`")
            return None
        if value.unit not in _PER_RADIAN and (value.unit is not None or value.value != 0):
            report.unit("an angle", value, "angles are in deg or rad")
            return None
        radians = float(value.value) / _PER_RADIAN[value.unit or "rad"]
        if not self.low - 1e-9 <= math.degrees(radians) <= self.high + 1e-9:
            report.range(value.span, f"this must be from {self.low:g} to {self.high:g} deg")
            return None
        return radians

    def write(self, value: float) -> str:
        return f"{print_float(value)} rad"


@dataclass(frozen=True, slots=True)
class Angles:
    """Two angles `(a, b)`, each within its own bounds."""

    units: ClassVar[tuple[str, ...]] = ANGLE_UNITS
    first: Angle
    second: Angle

    def read(self, value: SettingValue, report: Report) -> tuple[float, float] | None:
        if not isinstance(value, Pair):
            report.wrong(value, "two angles such as `(2 deg, 0 deg)`")
            return None
        first, second = self.first.read(value.x, report), self.second.read(value.y, report)
        return None if first is None or second is None else (first, second)

    def write(self, value: tuple[float, float]) -> str:
        return f"({self.first.write(value[0])}, {self.second.write(value[1])})"


@dataclass(frozen=True, slots=True)
class File:
    """A path in quotation marks."""

    units: ClassVar[tuple[str, ...]] = ()

    def read(self, value: SettingValue, report: Report) -> str | None:
        if not isinstance(value, Quoted):
            report.wrong(value, 'a path in quotation marks, such as `"table.json"`')
            return None
        return value.text

    def write(self, value: str) -> str:
        return f'"{value}"'


@dataclass(frozen=True, slots=True)
class HostPort:
    """A host and a port of this machine, in quotation marks."""

    units: ClassVar[tuple[str, ...]] = ()

    def read(self, value: SettingValue, report: Report) -> Address | None:
        if not isinstance(value, Quoted):
            report.wrong(value, 'an address in quotation marks, such as `"127.0.0.1:7420"`')
            return None
        try:
            return address_of(value.text)
        except ValueError as error:
            report.range(value.span, str(error))
            return None

    def write(self, value: Address) -> str:
        return f'"{value}"'


@dataclass(frozen=True, slots=True)
class Colour:
    """`rgb(red, green, blue)`, each a whole number from 0 to 255."""

    units: ClassVar[tuple[str, ...]] = ()

    def read(self, value: SettingValue, report: Report) -> tuple[int, int, int] | None:
        if not isinstance(value, Call) or value.name.text != "rgb" or len(value.arguments) != 3:
            report.wrong(value, "a colour such as `rgb(205, 198, 184)`")
            return None
        for argument in value.arguments:
            if not argument.is_whole or argument.value > 255:
                report.range(argument.span, "a colour has whole numbers from 0 to 255")
        red, green, blue = (int(argument.value) for argument in value.arguments)
        return red, green, blue

    def write(self, value: tuple[int, int, int]) -> str:
        return "rgb({}, {}, {})".format(*value)


@dataclass(frozen=True, slots=True)
class Image:
    """`width x height` in pixels, each from 16 to 4096, and not more than MOST_PIXELS in all."""

    units: ClassVar[tuple[str, ...]] = ()

    def read(self, value: SettingValue, report: Report) -> tuple[int, int] | None:
        if not isinstance(value, ImageSize):
            report.wrong(value, "a size such as `640 x 480`")
            return None
        for side in (value.width, value.height):
            if not side.is_whole or not 16 <= side.value <= 4096:
                report.range(side.span, "an image has 16 to 4096 pixels a side")
        width, height = value.width.value, value.height.value
        if max(width, height) <= 4096 and width * height > MOST_PIXELS:
            report.range(value.span, "this must have at most as many pixels as 1920 x 1080")
        return int(width), int(height)

    def write(self, value: tuple[int, int]) -> str:
        return "{} x {}".format(*value)


def _point(pair: Pair, report: Report) -> tuple[float, float]:
    """A coordinate that is none is 0, after a report."""
    return _coordinate(pair.x, report), _coordinate(pair.y, report)


def _coordinate(value: SettingValue, report: Report) -> float:
    metres = _metres(value, report) or 0.0
    if abs(metres) > LONGEST + SLACK:
        report.range(value.span, f"this must be at most {_length(LONGEST)} from the middle")
        return 0.0
    return metres


def _metres(value: SettingValue, report: Report) -> float | None:
    if not isinstance(value, Quantity):
        report.wrong(value, "a length such as `12 cm`")
        return None
    if value.unit is None and value.value == 0:
        return 0.0
    if value.unit is None or value.unit not in _PER_METRE:
        report.unit("a length", value, "lengths are in m, cm or mm")
        return None
    # Dividing the exact number gives the float nearest to what is written: 35 mm is 0.035.
    return float(value.value / _PER_METRE[value.unit])


def _number(value: SettingValue, report: Report) -> float | None:
    if not isinstance(value, Quantity):
        report.wrong(value, "a number")
        return None
    if value.unit is not None:
        help = f"leave out `{value.unit}`"
        report.findings.error("E503", "this number has no unit", value.span, help=help)
        return None
    return float(value.value)


def _m(metres: float) -> str:
    return f"{print_float(metres)} m"


def _length(metres: float) -> str:
    """A limit as it is written in a scene."""
    return next(f"{metres * n:g} {unit}" for unit, n in _PER_METRE.items() if metres * n >= 1 or n == 1000)


def centimetres(metres: float) -> str:
    """A length for a message."""
    return f"{metres * 100:.4g} cm"
