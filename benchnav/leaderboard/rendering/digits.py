"""Numbers as text, with as many digits as their interval resolves."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

PREFIXES = {  # unit → divisor, and the prefixed unit
    "s": ((1.0, "s"), (1e-3, "ms"), (1e-6, "µs"), (1e-9, "ns")),
    "B": ((1e9, "GB"), (1e6, "MB"), (1e3, "kB"), (1.0, "B")),
}
ROUNDING = 1e-12  # smaller numbers are rounding errors
NARROWEST = 1e-6  # smallest relative width of an interval that determines the digits
SMALLEST, LARGEST = 1e-4, 1e6  # numbers outside are written with an exponent
FIGURES_ALONE = 4  # at most, of a number without its interval
MOST_FIGURES = 5  # of the largest number of a column of equal decimals
RATE_DECIMALS = 2  # at least, in a column of rates
TWO_FIGURES = 3.0  # a half-width with a smaller first figure has a second one


def prefixed(unit: str, scale: float) -> tuple[float, str]:
    """Return the divisor that gives ``scale`` digits before the point, and the unit after it."""
    steps = PREFIXES.get(unit, ((1.0, unit),))
    if scale == 0.0:
        return 1.0, unit
    return next((step for step in steps if scale >= step[0]), steps[-1])


def number(value: float, whole: float | None = None) -> str:
    """Return about three figures of a number without an interval.

    ``whole`` is the end of a range, such as 1 of a rate: close to it, there are as many decimals
    as are needed to distinguish the number from it.
    """
    size = abs(value)
    if size <= ROUNDING:
        return "0"
    if not SMALLEST <= size < LARGEST:
        return f"{value:.1e}"
    power = _power(size)
    places = _places_alone(power)
    if whole is not None and size <= whole:
        if whole - size <= ROUNDING * whole:
            return f"{value:.0f}"
        places = max(places, -_power(whole - size))
    return f"{value:.{places}f}"


def figures(
    value: float, low: float, high: float, whole: float | None = None
) -> tuple[str, str, str]:
    """Return ``value``, ``low`` and ``high`` with the decimals that the interval resolves.

    Half the interval's width has one figure, or two if the first is 1 or 2 (DIN 1333). One
    more decimal is shown if two of the numbers, or a bound and 0 or ``whole``, would look
    equal and are not. If that is not enough, the value is shown a step of the last
    decimal within its bounds, and a bound close to 0 or ``whole`` as ``<0.001`` or ``>0.999``.

    Args:
        value: lies between the bounds.
        low: lower end of the interval.
        high: upper end.
        whole: end of the range, such as 1 of a rate; no effect if a number exceeds it.
    """
    grid, numbers, suffix = _grid((value, low, high), whole)
    if grid is None:
        text = number(value, whole)
        return text, text, text
    if not grid.distinguishes(numbers):
        grid = replace(grid, places=grid.places + 1)
    texts = [text if text == "0" else text + suffix for text in grid.texts(numbers)]
    return texts[0], texts[1], texts[2]


def figure(value: float, low: float, high: float, whole: float | None = None) -> str:
    """Return only ``value``, with the decimals that its interval resolves, to four figures.

    One more is shown if it would look like 0 or ``whole`` and is not.
    """
    grid, numbers, suffix = _grid((value, low, high), whole)
    if grid is None:
        return number(value, whole)
    if numbers[0] != 0.0:
        grid = replace(
            grid, places=min(grid.places, max(0, FIGURES_ALONE - 1 - _power(numbers[0])))
        )
    if grid.hides_end(numbers[0]):
        grid = replace(grid, places=grid.places + 1)
    text = grid.bound(numbers[0])
    return text if text == "0" else text + suffix


def aligned(
    rows: Sequence[tuple[float, float, float]], whole: float | None = None
) -> list[tuple[str, ...]] | None:
    """Return the texts of (value, low, high) of each row, all with equal decimals.

    The narrowest interval determines the decimals. 0 and ``whole`` have none. A row whose bounds
    are NaN gives only its value. None: the numbers are too different for equal decimals.
    """
    values = [abs(row[0]) for row in rows if abs(row[0]) > ROUNDING]
    sizes = [abs(x) for row in rows for x in row if abs(x) > ROUNDING]
    if not sizes:
        return [_texts(_Grid(0, whole), row) for row in rows]
    least, most = min(values or sizes), max(sizes)
    if most >= LARGEST or most > 10.0**MOST_FIGURES * least:
        return None
    widths = [high - low for _, low, high in rows if high - low > NARROWEST * most]
    places = max(map(_places, widths)) if widths else _places_alone(_power(least))
    if whole is not None and most > whole * (1 + ROUNDING):
        whole = None
    if whole is not None:
        places = max(places, RATE_DECIMALS)
    grid = _Grid(min(places, max(0, MOST_FIGURES - 1 - _power(most))), whole)
    return [_texts(grid, row) for row in rows]


def _texts(grid: "_Grid", row: tuple[float, float, float]) -> tuple[str, ...]:
    return tuple(grid.bound(0.0 if abs(x) <= ROUNDING else x) for x in row if not math.isnan(x))


def signed(text: str) -> str:
    """Return the text of a difference: ``+1.25``, ``−0.5``, ``0``, ``<+0.01``."""
    bare = text.lstrip("<>")
    mark = text[: len(text) - len(bare)]
    if float(bare) == 0.0:
        return mark + bare.removeprefix("-")
    return f"{mark}−{bare[1:]}" if bare.startswith("-") else f"{mark}+{bare}"


def _power(x: float) -> int:
    """Return the power of ten of the first figure."""
    return math.floor(math.log10(abs(x)))


def _places_alone(power: int) -> int:
    """Return the number of decimals of a number without an interval."""
    return max(0, 2 - max(power, 0)) if power >= -1 else 1 - power


def _places(width: float) -> int:
    """Return the number of decimals that show one or two figures of half a width."""
    power = _power(width / 2.0)
    second = width / 2.0 / 10.0**power < TWO_FIGURES
    return max(0, second - power)


def _grid(
    given: tuple[float, float, float], whole: float | None
) -> tuple["_Grid | None", list[float], str]:
    """Return the rounding grid of (value, low, high), the scaled numbers, and their exponent.

    The grid is None if the interval has no width that determines decimals.
    """
    numbers = [0.0 if abs(x) <= ROUNDING else x for x in given]
    scale = max(map(abs, numbers))
    if not numbers[2] - numbers[1] > NARROWEST * scale:
        return None, numbers, ""
    power = 0 if SMALLEST <= scale < LARGEST else _power(scale)
    numbers = [x / 10.0**power for x in numbers]
    if whole is not None and (power or scale > whole * (1 + ROUNDING)):
        whole = None
    places = _places(numbers[2] - numbers[1])
    return _Grid(places, whole), numbers, f"e{power:+03d}" if power else ""


@dataclass(frozen=True)
class _Grid:
    """Numbers rounded to ``places`` decimals, with protection against misleading equality."""

    places: int
    whole: float | None

    def distinguishes(self, numbers: Sequence[float]) -> bool:
        """Whether (value, low, high) stay distinct when rounded."""
        value, low, high = map(self._steps, numbers)
        ends = any(self.hides_end(x) for x in numbers[1:])
        return not ends and _apart(numbers, (value, low, high))

    def texts(self, numbers: Sequence[float]) -> tuple[str, str, str]:
        """Return the value, kept within its bounds, and the bounds."""
        low, high = map(self.bound, numbers[1:])
        if _same(numbers[0], numbers[1]) or _same(numbers[0], numbers[2]):
            return (low if _same(numbers[0], numbers[1]) else high), low, high
        value, least, most = map(self._steps, numbers)
        value = min(max(value, least + 1), most - 1)
        return self._exact(numbers[0]) or self._text(value), low, high

    def _steps(self, x: float) -> int:
        return round(x * 10.0**self.places)

    def _text(self, steps: int) -> str:
        return f"{steps / 10.0**self.places:.{self.places}f}"

    def _exact(self, x: float) -> str | None:
        """Return 0 and the ends of the range without decimals."""
        if x == 0.0:
            return "0"
        if self.whole is not None and _same(abs(x), self.whole):
            return f"{x:.0f}"
        return None

    def hides_end(self, x: float) -> bool:
        """Whether a number that is not 0 or an end of the range would look like one."""
        steps = abs(self._steps(x))
        ends = (0,) if self.whole is None else (0, self._steps(self.whole))
        return self._exact(x) is None and steps in ends

    def bound(self, x: float) -> str:
        """Return the text of a bound, or of a number without bounds."""
        steps = self._steps(x)
        if not self.hides_end(x):
            return self._exact(x) or self._text(steps)
        if steps == 0:
            return "<" + self._text(1) if x > 0 else ">" + self._text(-1)
        return ">" + self._text(steps - 1) if x > 0 else "<" + self._text(steps + 1)


def _same(a: float, b: float) -> bool:
    return math.isclose(a, b, rel_tol=1e-9, abs_tol=ROUNDING)


def _apart(numbers: Sequence[float], steps: Sequence[int]) -> bool:
    """Whether the value differs from each bound on the grid if it differs at all."""
    return all(_same(numbers[0], numbers[k]) or steps[0] != steps[k] for k in (1, 2))
