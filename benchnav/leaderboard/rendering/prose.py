"""Sentences about a comparison: the difference, its size, and its significance."""

import math
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence

from benchnav.errors import UsageError
from benchnav.leaderboard.record import ALL
from benchnav.leaderboard.rendering import escape
from benchnav.leaderboard.rendering.digits import figures, number, prefixed
from benchnav.leaderboard.rendering.digits import signed as with_sign
from benchnav.leaderboard.rendering.long_format import as_csv, as_json
from benchnav.leaderboard.statistics.comparison import Comparison
from benchnav.leaderboard.statistics.head_to_head import Duel
from benchnav.leaderboard.statistics.trainings import Spread
from benchnav.metrics.metric import Metric
from benchnav.scenario.condition import described
from benchnav.text.plural import counted

FORMATS = ("markdown", "csv", "json")
SMALLEST = 1e-4  # smaller p are only called smaller than this
VERBS = {
    "success": "succeeds", "arrival": "arrives", "collided": "collides", "timeout": "times out",
    "stuck": "gets stuck", "failed": "fails",
}  # fmt: skip
"""The verbs of rates of events of an agent; all other metrics are "higher" or "lower"."""

TRAININGS = (
    " A value of an entry with several trainings is their mean; the last interval of a line is over"
    " worlds and trainings. An entry that was trained once is assumed to vary as the other one."
)
ARRIVALS = "among agents that arrive"


def render_duel(duel: Duel, metrics: Mapping[str, Metric], format: str = "markdown") -> str:
    """Return a comparison as text that ends with a line break: sentences, or tidy CSV or JSON.

    Raises UsageError for another format.
    """
    if format not in FORMATS:
        raise UsageError(f"A comparison comes as {', '.join(FORMATS)}. Got {format!r} instead.")
    if format == "json":
        return as_json(duel.comparisons)
    if format == "csv":
        return as_csv(Comparison, duel.comparisons)
    lines = [f"# {escape.markdown(f'{duel.first} against {duel.second}')}", ""]
    for name in dict.fromkeys(c.metric for c in duel.comparisons):
        chosen = [c for c in duel.comparisons if c.metric == name]
        lines += _block(chosen, metrics[name])
    lines += [f"{_explained(duel)}", ""]
    for note in duel.notes:
        lines.append(f"- {escape.markdown(note)}")
    return "\n".join([*lines, ""] if duel.notes else lines)


def _block(found: Sequence[Comparison], metric: Metric) -> list[str]:
    """Return the sentences about one metric, its outcome first."""
    roles, splits = {c.role for c in found}, {c.split for c in found}
    lines = [f"## {escape.markdown(metric.name)}: {escape.markdown(outcome(found))}", ""]
    lines += [f"{escape.markdown(metric.title)}.", ""]
    for c in found:
        where = place(c, role=len(roles) > 1, split=splits != {"test"})
        lines.append(f"- {escape.markdown(f'{where}: {sentence(c, metric)}')}")
    widest = [c for c in found if c.scenario == ALL] or found
    several = (text for c in widest[:1] for text in training_sentences(c, metric))
    return [*lines, *(f"- {escape.markdown(text)}" for text in several), ""]


def outcome(found: Sequence[Comparison]) -> str:
    """Return how often each verdict about the first navigator occurs."""
    counts = Counter(c.verdict for c in found)
    if len(found) == 1:
        return str(found[0].verdict)
    return ", ".join(f"{verdict} in {n} of {len(found)}" for verdict, n in counts.most_common())


def place(c: Comparison, *, role: bool, split: bool) -> str:
    """Return the place of a comparison, ``leaders/dynamic@1, track unknown (100 worlds)``."""
    scenario = "all scenarios" if c.scenario == ALL else c.scenario
    parts = [scenario, described(c.track, c.perception)]
    parts += [f"{c.role}s"] if role else []
    parts += [f"split {c.split}"] if split else []
    return f"{', '.join(parts)} ({counted(c.worlds, 'world')})"


def sentence(c: Comparison, metric: Metric) -> str:
    """Return the sentence of one comparison, and of its trainings if an entry has several."""
    more = "" if math.isnan(c.training_low) else f" {over_trainings(c, metric)}"
    return f"{_sentence(c, metric)}{more}"


def over_trainings(c: Comparison, metric: Metric) -> str:
    """Return the sentence about the interval over worlds and trainings, which must be known."""
    bounds = [c.training_low, c.training_high]
    value, ends, unit = _figures(metric, c.difference, bounds, plus=True)
    verdict = "With other trainings"
    if c.verdict not in ("tie", "too few worlds", "not as equals"):
        holds = c.training_low > 0.0 or c.training_high < 0.0
        verdict = "It also holds for other trainings" if holds else "Other trainings may reverse it"
    return f"{verdict}: {value}{unit}{ends}."


def training_sentences(c: Comparison, metric: Metric) -> Iterator[str]:
    """Yield how much two trainings of the same recipe differ, for entries with several."""
    sides = (
        (c.first, c.first_trainings, c.first_deviation),
        (c.second, c.second_trainings, c.second_deviation),
    )
    for name, count, deviation in sides:
        if count < 2 or math.isnan(deviation):
            continue
        apart = Spread(count, deviation=deviation).of_two
        spread = f"the standard deviation of {count} trainings is {_size(deviation, metric)}"
        if apart < metric.high - metric.low:
            yield (
                f"One training seed: two trainings of {name} differ by up to"
                f" {_size(apart, metric)} (95 %; {spread})."
            )
        else:
            yield f"One training seed: {spread} for {name}; more trainings would show its worth."


def _size(value: float, metric: Metric) -> str:
    """Return a difference with two figures and its unit."""
    size, unit = scaled(metric, value)
    return f"{float(f'{value / size:.2g}'):g}{f' {unit}' if unit else ''}"


def _sentence(c: Comparison, metric: Metric) -> str:
    if not c.worlds:
        return "no world in which both have a value."
    if c.verdict == "tie":
        nothing = c.difference == 0.0 and c.p == 1.0
        chance = "" if nothing else f"; {_chance(c)}"
        return f"a tie, {signed(c, metric)}{chance}."
    if c.verdict == "too few worlds":
        return f"too few worlds to tell, {signed(c, metric)}."
    text = f"{_difference(c, metric)}; {_chance(c)}"
    return f"{text}. Not as equals." if c.verdict == "not as equals" else f"{text}."


def _difference(c: Comparison, metric: Metric) -> str:
    """Return ``A succeeds 4.2 points more often [2.9, 5.6]``."""
    sign = math.copysign(1.0, c.difference)
    bounds = sorted((sign * c.low, sign * c.high))
    value, ends, unit = _figures(metric, sign * c.difference, bounds)
    verb = VERBS.get(metric.name)
    if verb:
        return f"{c.first} {verb} {value}{unit} {'more' if sign > 0 else 'less'} often{ends}"
    way = "higher" if sign > 0 else "lower"
    parts: list[str] = [c.verdict] if c.verdict in ("better", "worse") else []
    parts += [ARRIVALS] if metric.conditional else []
    good = f" ({', '.join(parts)})" if parts else ""
    return f"{metric.name} of {c.first} is {value}{unit} {way}{ends}{good}"


def signed(c: Comparison, metric: Metric) -> str:
    """Return ``A − B = +0.5 points [−2.1, +3.0]``."""
    value, ends, unit = _figures(metric, c.difference, [c.low, c.high], plus=True)
    return f"{c.first} − {c.second} = {value}{unit}{ends}"


def scaled(metric: Metric, widest: float) -> tuple[float, str]:
    """Return the divisor of differences of a metric, and their unit; rates are in points."""
    return (0.01, "points") if metric.rate else prefixed(metric.unit, widest)


def _figures(
    metric: Metric, value: float, bounds: Sequence[float], plus: bool = False
) -> tuple[str, str, str]:
    """Return value, interval and unit; the last two begin with a space."""
    known = [x for x in bounds if not math.isnan(x)]
    size, unit = scaled(metric, max(map(abs, (value, *known))))
    whole = 100.0 if metric.rate else None  # points
    texts: tuple[str, ...]
    if known:
        texts = figures(value / size, known[0] / size, known[1] / size, whole)
    else:
        texts = (number(value / size, whole),)
    first, *ends = (with_sign(text) if plus else with_sign(text).replace("+", "") for text in texts)
    return first, f" [{', '.join(ends)}]" if ends else "", f" {unit}" if unit else ""


def _chance(c: Comparison) -> str:
    """Return how often chance alone gives such a difference, from p after Holm's correction."""
    p = c.adjusted
    if p < SMALLEST:
        return f"by chance less than once in {1 / SMALLEST:,.0f} times"
    if p >= 0.95:
        return "as chance alone would give"
    if p >= 0.1:
        return f"by chance {counted(round(10 * p), 'time')} in 10"
    times = math.floor(1 / p)
    return f"by chance once in {times if times < 100 else round(times, -1):,} times"


def _explained(duel: Duel) -> str:
    family = max(c.family for c in duel.comparisons)
    several = any(not math.isnan(c.training_low) for c in duel.comparisons)
    return (
        "[low, high]: 95 % interval of the mean difference over the worlds of both. By chance: how"
        " often a difference as large would be seen if the true one were 0, by the t-test of the"
        " same interval, adjusted by Holm's procedure for the"
        f" {counted(family, 'comparison')} above as one family. Rarer than once in"
        " 20 it is called a difference. Intervals are not adjusted: one may exclude 0 in a tie."
        " Scenarios are fixed: other seeds may differ, not other scenarios."
        f"{TRAININGS if several else ''}"
    )
