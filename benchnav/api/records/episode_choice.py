"""Choose stored episodes the way people name them: the failed ones, the worst ones."""

import math
from collections.abc import Mapping, Sequence

import pyarrow.compute as pc

from benchnav.api.records.episodes import Episodes, Place, stored_episodes
from benchnav.errors import UsageError, did_you_mean
from benchnav.store.runs.reading import results_of
from benchnav.store.runs.run_folder import RunFolder

SUCCESS = "success"
Key = tuple[str, str, str, int]  # navigator, scenario, track, seed


def failed_episodes(folder: RunFolder, places: Sequence[Place], owner: object = None) -> Episodes:
    """Return those in which an evaluated agent did not succeed, in the same order."""
    values = _values(folder, SUCCESS)
    lost = [place for place in places if min(values.get(_key(place), [1.0])) < 1.0]
    return Episodes(lost, owner)


def worst_episodes(
    folder: RunFolder, places: Sequence[Place], metric: str, owner: object = None
) -> Episodes:
    """Return those in which a metric is defined, worst first.

    Raises UsageError for a metric that the run does not hold, or that has no better side.
    """
    from benchnav.metrics.declared import declared_metrics

    declared = declared_metrics()[0]
    values = _values(folder, metric)
    better = declared[metric].better if metric in declared else None
    if better is None:
        raise UsageError(
            "The metric must have a better side, higher or lower, to define the worst."
            f" {metric!r} has none; {SUCCESS!r} and 'collided' have one."
        )
    worst, sign = (min, 1.0) if better == "higher" else (max, -1.0)
    known = [place for place in places if _key(place) in values]
    return Episodes(sorted(known, key=lambda place: sign * worst(values[_key(place)])), owner)


def in_same_world(
    folder: RunFolder, place: Place, navigators: Sequence[str], owner: object = None
) -> Episodes:
    """Return the episodes of several navigators in the world and track of one episode.

    Raises UsageError for a navigator that was not run there.
    """
    found = []
    for navigator in navigators:
        there = stored_episodes(folder, navigator, place.scenario, place.track, place.seed).places
        if not there:
            raise UsageError(
                f"Every navigator must have been run in {place.scenario}, track {place.track},"
                f" seed {place.seed}. {navigator!r} was not."
            )
        found.append(there[0])
    return Episodes(found, owner)


def _values(folder: RunFolder, metric: str) -> Mapping[Key, list[float]]:
    """Return the defined values of a metric: one for each role of an episode.

    Raises UsageError for a metric that the run does not hold.
    """
    table = results_of(folder)
    held = table["metric"].unique().to_pylist()
    if metric not in held:
        raise UsageError(
            f"The metric must be one that the run holds. Got {metric!r} instead."
            f"{did_you_mean(metric, held)}"
        )
    table = table.filter(pc.equal(table["metric"], metric))
    names = ("navigator", "scenario", "track", "seed", "value")
    found: dict[Key, list[float]] = {}
    for *key, value in zip(*(table[name].to_pylist() for name in names), strict=True):
        if not math.isnan(value):
            found.setdefault(tuple(key), []).append(value)
    return found


def _key(place: Place) -> Key:
    return place.navigator, place.scenario, place.track, place.seed
