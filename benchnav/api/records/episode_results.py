"""How stored episodes ended, from the values that were measured on them."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import pyarrow.compute as pc

from benchnav.api.records.episode_choice import SUCCESS, key_of, metric_values
from benchnav.api.records.episodes import Place
from benchnav.report.failed_episodes import CAUSES
from benchnav.store.runs.reading import results_of
from benchnav.store.runs.run_folder import RunFolder


@dataclass(frozen=True)
class EpisodeResult:
    """How one stored episode ended."""

    success: float  # share of the evaluated agents; of the worse role if there are two
    causes: tuple[str, ...]  # in words, why agents did not succeed
    duration: float  # [s]


def episode_results(folder: RunFolder, places: Sequence[Place]) -> list[EpisodeResult]:
    """Return the result of each episode. No episode is decoded for it."""
    table = results_of(folder, undisturbed=True)
    success = metric_values(table, SUCCESS)
    causes = {words: metric_values(table, name) for name, words in CAUSES.items()}
    rows = table.filter(pc.equal(table["metric"], SUCCESS))
    names = ("navigator", "scenario", "track", "perception", "seed", "dt")
    columns = (rows[name].to_pylist() for name in names)
    step = {tuple(key): dt for *key, dt in zip(*columns, strict=True)}
    steps = {part: part.steps() for part in dict.fromkeys(place.part for place in places)}
    found = []
    for place in places:
        key = key_of(place)
        share = min(success.get(key, [math.nan]))
        why = (words for words, values in causes.items() if max(values.get(key, [0.0])) > 0.0)
        duration = steps[place.part][place.seed] * step[key]
        found.append(EpisodeResult(share, () if share == 1.0 else tuple(why), duration))
    return found
