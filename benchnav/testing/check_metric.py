"""The checks that every metric must pass, also those of plugins.

`check_metric(metric)` raises AssertionError with a sentence that names the violated rule.
The checks do not know the meaning of a metric; they test rules that hold for all metrics.
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
FLOOR = 1e-9  # absolute: rounding of zero
QUARTER = 0.5 * math.pi
_UNRANKED = "a value that an early end cuts short must not rank. Declare it with better=None."


def check_metric(metric: Metric) -> None:
    """Check that ``metric`` keeps the contract of metrics.

    Its record is valid. It gives one value per agent (or one per group) within the declared
    range. The values do not change in a second call, if the episode is moved, turned,
    renamed or recorded with other decision steps, or if the agents are reordered. Records
    after an agent's attempt do not count. Only success gets a perfect score, and a crash never
    improves the score.
    """
    for check in CHECKS:
        check(metric)


def values(metric: Metric, episode: Episode) -> FloatArray:
    """Return (A,) values of a metric of agents; (1,) of a metric of a group, for all evaluated."""
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
    """Check that name, range and direction are valid."""
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
    """Check that every value is NaN or within the declared range; a rate is 0 or 1."""
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
    """Check that the same episode has the same value again, and that a copy has it too."""
    for title, episode in zoo().items():
        _same(metric, values(metric, episode), values(metric, episode), "twice", title, 0.0)
        copy = replace(episode)
        _same(metric, values(metric, episode), values(metric, copy), "of a copy", title, 0.0)


def check_blind(metric: Metric) -> None:
    """Check that names, seeds and (for a verifiable metric) timings do not matter."""
    for title, episode in zoo().items():
        other = replace(episode, identity=Identity("x/y@2", "f", "train", 7, "unknown", "another"))
        if metric.verifiable:
            slower = replace(other.timings, decision=10.0 * other.timings.decision, planning=9.0)
            other = replace(other, timings=slower)
        _same(
            metric, values(metric, episode), values(metric, other),
            "under another name and (unless it is marked not verifiable) with other timings",
            title, 0.0,
        )  # fmt: skip


def check_place(metric: Metric) -> None:
    """Check that the origin and the direction of the x axis do not matter."""
    for title, episode in zoo().items():
        angles = [QUARTER] if episode.world.measurement_area else [QUARTER, 0.7]
        for angle, offset in [(0.0, (13.0, -7.0)), *((a, (0.0, 0.0)) for a in angles)]:
            other = moved(episode, angle, offset)
            change = f"turned by {angle:.2f} rad and moved by {offset}"
            _same(metric, values(metric, episode), values(metric, other), change, title)


def check_order(metric: Metric) -> None:
    """Check that the order of agents does not matter."""
    for title, episode in zoo().items():
        order = np.roll(np.arange(len(episode.world.agents))[::-1], 1)
        before, after = values(metric, episode), values(metric, reordered(episode, order))
        expected = before if metric.scope == "group" else before[order]
        _same(metric, expected, after, "with its agents in another order", title)


def check_sampling(metric: Metric) -> None:
    """Check that the same smooth motion has the same value at dt, dt/2 and dt/5."""
    if not metric.verifiable:
        return
    for title, scene in [("smooth", smooth()), ("crowd", crowd())]:
        coarse = values(metric, scene.episode())
        for factor in (2, 5):
            fine = values(metric, scene.episode(factor))
            change = f"recorded with dt/{factor}"
            _same(metric, coarse, fine, change, title, SAMPLING)


def check_after(metric: Metric) -> None:
    """Check that records after the end of an agent's attempt do not count."""
    if metric.scope == "group" or not metric.verifiable:
        return
    short, long = values(metric, with_company(1.0)), values(metric, with_company(0.4))
    _same(
        metric, short[:1], long[:1], "of an agent that had arrived, in a longer record,", "company"
    )


def check_unearned(metric: Metric) -> None:
    """Check that an agent that stands still, fails or crashes at once has no perfect score."""
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
    """Check that a crash half-way scores no better than arrival on the same path."""
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
    """Check that a metric that is declared for arrivals only is NaN for all other agents."""
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
    change: str,
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
        f"{metric.name} must not change {change}. Got {got} in place of {expected}"
        f" in the episode {title!r}.",
    )


def _require(condition: object, message: str) -> None:
    if not condition:
        raise AssertionError(message)
