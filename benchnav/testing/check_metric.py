"""What every metric must pass, the ones that ship and anybody's.

`check_metric(metric)` raises AssertionError with a sentence that says what is wrong.
Nothing here knows what a metric means; it knows what no metric may do.
"""

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from benchnav.arrays import FloatArray
from benchnav.episode.episode import Episode, Identity
from benchnav.metrics.metric import Metric
from benchnav.testing.transform import moved, reordered
from benchnav.testing.zoo import crowd, smooth, with_company, zoo

ROUNDING = (
    1e-6  # of the greatest value in the episode: another place or order changes rounding only
)
SAMPLING = 0.05  # of the greatest value in the episode: dt, dt/2 and dt/5 of the same smooth motion
FLOOR = 1e-9  # absolute: rounding of what is zero
QUARTER = 0.5 * math.pi
_UNRANKED = "what an early end cuts short ranks nobody. Declare it with better=None."


def check_metric(metric: Metric) -> None:
    """Hold ``metric`` to what every metric must be.

    A sound record; one value per agent (or one, of a group) within the declared range;
    the same answer twice, in another place, turned, with agents reordered, under another
    name, and recorded with other decision steps; nothing after an agent's attempt
    counts; nothing but success earns a perfect score, and crashing never a better one.
    """
    for check in CHECKS:
        check(metric)


def values(metric: Metric, episode: Episode) -> FloatArray:
    """(A,) for a metric of agents; (1,) for one of a group, of all evaluated agents."""
    if metric.scope == "group":
        return np.array([metric.function(episode, episode.world.agents.evaluated)], np.float64)
    answer = metric.function(episode)
    if not isinstance(answer, np.ndarray):
        raise AssertionError(f"{metric.name} must return an array. Got {type(answer).__name__}.")
    expected = (len(episode.world.agents),)
    _require(
        answer.shape == expected,
        f"{metric.name} must return one value per agent, shape {expected}. Got {answer.shape}.",
    )
    return answer.astype(np.float64)


def check_record(metric: Metric) -> None:
    """Name, range and direction make sense."""
    name = metric.name
    _require(name.isidentifier() and name.islower(), f"{name!r} must be snake_case.")
    _require(metric.title and metric.reference, f"{name} must have a title and a reference.")
    _require(metric.low < metric.high, f"{name}: low must be below high.")
    _require(metric.better in ("higher", "lower", None), f"{name}: better must be higher or lower.")
    _require(
        not metric.rate or (metric.low, metric.high) == (0.0, 1.0),
        f"{name} is a rate, so its range must be 0 to 1.",
    )


def check_range(metric: Metric) -> None:
    """Every value is NaN or within the declared range; a rate is 0 or 1."""
    for title, episode in zoo().items():
        for value in values(metric, episode):
            fits = math.isnan(value) or metric.low - 1e-9 <= value <= metric.high + 1e-9
            _require(
                fits,
                f"{metric.name} must be within [{metric.low}, {metric.high}]."
                f" Got {value} in the episode {title!r}.",
            )
            _require(
                not math.isinf(value),
                f"{metric.name} must be NaN where it is undefined. Got {value} in {title!r}.",
            )
            _require(
                not metric.rate or math.isnan(value) or value in (0.0, 1.0),
                f"{metric.name} is a rate: an agent has 0 or 1. Got {value} in {title!r}.",
            )


def check_pure(metric: Metric) -> None:
    """The same episode has the same value, and a copy of it has too."""
    for title, episode in zoo().items():
        _same(metric, values(metric, episode), values(metric, episode), "twice", title, 0.0)
        copy = replace(episode)
        _same(metric, values(metric, episode), values(metric, copy), "of a copy", title, 0.0)


def check_blind(metric: Metric) -> None:
    """Neither names nor seeds nor, unless it says so, timings matter."""
    for title, episode in zoo().items():
        other = replace(episode, identity=Identity("x/y@2", "f", "train", 7, "unknown", "somebody"))
        if metric.verifiable:
            slower = replace(other.timings, decision=10.0 * other.timings.decision, planning=9.0)
            other = replace(other, timings=slower)
        _same(
            metric, values(metric, episode), values(metric, other),
            "under another name and (unless it is marked not verifiable) with other timings",
            title, 0.0,
        )  # fmt: skip


def check_place(metric: Metric) -> None:
    """Where the origin is and where x points do not matter."""
    for title, episode in zoo().items():
        angles = [QUARTER] if episode.world.measurement_area else [QUARTER, 0.7]
        for angle, offset in [(0.0, (13.0, -7.0)), *((a, (0.0, 0.0)) for a in angles)]:
            other = moved(episode, angle, offset)
            what = f"turned by {angle:.2f} rad and moved by {offset}"
            _same(metric, values(metric, episode), values(metric, other), what, title)


def check_order(metric: Metric) -> None:
    """The order of agents does not matter."""
    for title, episode in zoo().items():
        order = np.roll(np.arange(len(episode.world.agents))[::-1], 1)
        before, after = values(metric, episode), values(metric, reordered(episode, order))
        expected = before if metric.scope == "group" else before[order]
        _same(metric, expected, after, "with its agents in another order", title)


def check_sampling(metric: Metric) -> None:
    """The same smooth motion has the same value at dt, dt/2 and dt/5."""
    if not metric.verifiable:
        return
    for title, scene in [("smooth", smooth()), ("crowd", crowd())]:
        coarse = values(metric, scene.episode())
        for factor in (2, 5):
            fine = values(metric, scene.episode(factor))
            what = f"recorded with dt/{factor}"
            _same(metric, coarse, fine, what, title, SAMPLING)


def check_after(metric: Metric) -> None:
    """What is recorded after an agent's attempt was over does not count."""
    if metric.scope == "group" or not metric.verifiable:
        return
    short, long = values(metric, with_company(1.0)), values(metric, with_company(0.4))
    _same(
        metric, short[:1], long[:1], "of an agent that had arrived, in a longer record,", "company"
    )


def check_unearned(metric: Metric) -> None:
    """Who stands, fails or crashes at once has no perfect score."""
    best = {"higher": metric.high, "lower": metric.low}.get(metric.better or "")
    if best is None or not metric.verifiable:
        return
    names = ("idle", "failing", "crashing")
    perfect = [name for name in names if float(values(metric, zoo()[name])[0]) == best]
    if metric.better == "higher":
        _require(
            not perfect,
            f"{metric.name} must be NaN or imperfect for an agent that gets nowhere."
            f" Got {best}, its best, in the episodes {perfect}.",
        )
    _require(
        "crashing" not in perfect,
        f"{metric.name} must not be perfect ({best}) for an agent that crashes at once:"
        f" {_UNRANKED}",
    )


def check_crash(metric: Metric) -> None:
    """Who crashes half-way does not score better than who walks the same way and arrives."""
    if metric.better is None or metric.conditional or not metric.verifiable:
        return
    whole, part = (float(values(metric, zoo()[name])[0]) for name in ("errand", "broken off"))
    gain = part - whole if metric.better == "higher" else whole - part
    _require(
        not gain > ROUNDING * max(abs(whole), abs(part)),
        f"{metric.name} must not be better for an agent that crashes half-way ({part}) than for"
        f" one that walks the same way and arrives ({whole}): {_UNRANKED}",
    )


def check_conditional(metric: Metric) -> None:
    """What is declared for arrivals alone is NaN for everybody else."""
    if not metric.conditional:
        return
    for title, episode in zoo().items():
        found = values(metric, episode)
        mine = episode.world.agents.evaluated
        missing = np.isnan(episode.arrival) | bool(episode.failure)
        wrong = (
            missing[mine].any() and not math.isnan(found[0])
            if metric.scope == "group"
            else bool((~np.isnan(found[missing])).any())
        )
        _require(
            not wrong,
            f"{metric.name} is declared conditional, so it must be NaN for agents that did"
            f" not arrive. Got {found} in the episode {title!r}.",
        )


CHECKS: tuple[Callable[[Metric], None], ...] = (
    check_record, check_range, check_pure, check_blind, check_place, check_order,
    check_sampling, check_after, check_unearned, check_crash, check_conditional,
)  # fmt: skip


def _same(
    metric: Metric,
    expected: FloatArray,
    got: FloatArray,
    what: str,
    title: str,
    tolerance: float = ROUNDING,
) -> None:
    sizes = np.abs(np.concatenate([expected, got]))
    scale = float(np.max(sizes[np.isfinite(sizes)], initial=0.0))
    allowed = tolerance * scale + (FLOOR if tolerance else 0.0)
    near = (expected == got) | (np.abs(expected - got) <= allowed)
    near |= np.isnan(expected) & np.isnan(got)
    _require(
        near.all(),
        f"{metric.name} must not change {what}. Got {got} in place of {expected}"
        f" in the episode {title!r}.",
    )


def _require(condition: object, message: str) -> None:
    if not condition:
        raise AssertionError(message)
