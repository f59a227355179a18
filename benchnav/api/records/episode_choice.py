"""Choose stored episodes the way people name them: the failed ones, the worst ones."""

import math
from collections.abc import Mapping, Sequence

import pyarrow as pa
import pyarrow.compute as pc

from benchnav.api.records.episodes import Episodes, Place, stored_episodes
from benchnav.errors import UsageError, did_you_mean
from benchnav.report.failed_episodes import CAUSES
from benchnav.scenario.condition import described
from benchnav.store.runs.reading import results_of
from benchnav.store.runs.run_folder import RunFolder

SUCCESS = "success"
Key = tuple[str, str, str, str, int]  # navigator, scenario, track, perception, seed


def failed_episodes(
    folder: RunFolder, places: Sequence[Place], owner: object = None, cause: str | None = None
) -> Episodes:
    """Return those in which an evaluated agent did not succeed, in the same order.

    ``cause`` is one of `CAUSES`, and keeps those in which it applies to an agent. Raises UsageError
    for another one.
    """
    if cause is not None and cause not in CAUSES:
        raise UsageError(
            f"The cause of a failure must be one of {', '.join(CAUSES)}. Got {cause!r} instead."
            f"{did_you_mean(cause, CAUSES)}"
        )
    table = results_of(folder)
    values = metric_values(table, SUCCESS)
    lost = [place for place in places if min(values.get(key_of(place), [1.0])) < 1.0]
    if cause is not None:
        found = metric_values(table, cause)
        lost = [place for place in lost if max(found.get(key_of(place), [0.0])) > 0.0]
    return Episodes(lost, owner)


def worst_episodes(
    folder: RunFolder, places: Sequence[Place], metric: str, owner: object = None
) -> Episodes:
    """Return those in which a metric is defined, worst first.

    Raises UsageError for a metric that the run does not hold, or that has no better side.
    """
    from benchnav.metrics.declared import declared_metrics

    declared = declared_metrics()[0]
    better = {name: found.better for name, found in declared.items() if found.better is not None}
    table = results_of(folder)
    held = table["metric"].unique().to_pylist()
    ranked = sorted(name for name in held if name in better)
    if metric not in ranked:
        problem = f"{metric!r} has none" if metric in held else f"Got {metric!r} instead"
        raise UsageError(
            "The metric must be one that the run holds and that has a better side, to define the"
            f" worst: {', '.join(ranked)}. {problem}.{did_you_mean(metric, ranked)}"
        )
    values = metric_values(table, metric)
    worst, sign = (min, 1.0) if better[metric] == "higher" else (max, -1.0)
    known = [place for place in places if key_of(place) in values]
    return Episodes(sorted(known, key=lambda place: sign * worst(values[key_of(place)])), owner)


def in_same_world(
    folder: RunFolder, place: Place, navigators: Sequence[str], owner: object = None
) -> Episodes:
    """Return the episodes of several navigators in the world and condition of one episode.

    Raises UsageError for a navigator that was not run there.
    """
    found = []
    for navigator in navigators:
        there = stored_episodes(
            folder, navigator, place.scenario, place.track, place.perception, place.seed
        ).places
        if not there:
            where = described(place.track, place.perception)
            raise UsageError(
                f"Every navigator must have been run in {place.scenario}, {where},"
                f" seed {place.seed}. {navigator!r} was not."
            )
        found.append(there[0])
    return Episodes(found, owner)


def metric_values(table: pa.Table, metric: str) -> Mapping[Key, list[float]]:
    """Return the defined values of a metric: one for each role of an episode."""
    table = table.filter(pc.equal(table["metric"], metric))
    names = ("navigator", "scenario", "track", "perception", "seed", "value")
    found: dict[Key, list[float]] = {}
    for *key, value in zip(*(table[name].to_pylist() for name in names), strict=True):
        if not math.isnan(value):
            found.setdefault(tuple(key), []).append(value)
    return found


def key_of(place: Place) -> Key:
    """Return navigator, scenario, track, perception and seed."""
    return place.navigator, place.scenario, place.track, place.perception, place.seed
