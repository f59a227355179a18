"""Find stored episodes by name: NAVIGATOR/SCENARIO/TRACK/SEED, or …/TRACK/PERCEPTION/SEED."""

from collections.abc import Iterable
from typing import TYPE_CHECKING

from benchnav.api.records.episodes import Episodes, Place
from benchnav.errors import UsageError, did_you_mean
from benchnav.leaderboard.from_runs import names_of_scenario
from benchnav.scenario.condition import EXACT
from benchnav.scenario.terms import TRACKS

if TYPE_CHECKING:
    from benchnav.api.records.run import Run


def named_episodes(run: "Run", names: Iterable[str]) -> Episodes:
    """Return the episodes of a run with these names, whose scenarios may lack their versions.

    Raises UsageError for a name that no episode has, or that two have.
    """
    return Episodes([_find(run, name) for name in names], run)


def _find(run: "Run", name: str) -> Place:
    parts = name.rsplit("/", 2) if name.count("/") >= 3 else []
    if not parts or not parts[2].isdigit():
        example = next((place.name for place in run.episodes().places), "")
        raise UsageError(
            f"An episode must be named NAVIGATOR/SCENARIO/TRACK/SEED, such as {example}."
            f" Got {name!r} instead."
        )
    subject, track, seed = parts
    perception = EXACT
    if track not in TRACKS and subject.rpartition("/")[2] in TRACKS:
        perception, (subject, track) = track, subject.rsplit("/", 1)
    found = [
        place
        for place in run.episodes(track=track, seed=int(seed)).places
        if place.perception == perception
        and subject in (f"{place.navigator}/{form}" for form in names_of_scenario(place.scenario))
    ]
    found = [place for place in found if place.name == name] or found
    if not found:
        near = did_you_mean(name, [place.name for place in run.episodes().places])
        raise UsageError(f"There is no stored episode {name!r} in {run.path}.{near}")
    if len(found) > 1:
        both = " and ".join(place.name for place in found[:2])
        raise UsageError(f"An episode must be named completely. {name!r} stands for {both}.")
    return found[0]
