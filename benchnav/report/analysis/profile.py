"""The profile of navigators: the mean of a metric over each family of scenarios."""

from collections.abc import Mapping, Sequence

import pyarrow as pa
import pyarrow.compute as pc

from benchnav.leaderboard.record import ALL, Record
from benchnav.leaderboard.table import leaderboard
from benchnav.metrics.metric import Metric
from benchnav.report.analysis.view import View, view_of

Profile = dict[View, dict[str, dict[str, Record]]]
"""View → family → navigator → record."""


def profile(
    results: pa.Table,
    metrics: Mapping[str, Metric],
    metric: str,
    families: Mapping[str, Sequence[str]],
) -> Profile:
    """Return the mean of one metric, with its interval, over the scenarios of each family.

    ``results`` has the schema `benchnav.store.parts.results.RESULTS`; ``families`` maps a family
    to its scenarios. The numbers are those of the leaderboard of these scenarios alone.
    """
    chosen = results.filter(pc.equal(results["metric"], metric))
    found: Profile = {}
    for family, scenarios in families.items():
        rows = chosen.filter(pc.is_in(chosen["scenario"], pa.array(scenarios, pa.string())))
        if not len(rows):
            continue
        for record in _means(leaderboard(rows, metrics).records):
            by_family = found.setdefault(view_of(record), {})
            by_family.setdefault(family, {})[record.navigator] = record
    return found


def _means(records: Sequence[Record]) -> list[Record]:
    """Return the records over all scenarios, or those of the only scenario."""
    held = [r for r in records if not r.price and r.episodes]
    whole = [r for r in held if r.scenario == ALL]
    covered = {(view_of(r), r.navigator) for r in whole}
    return whole + [r for r in held if (view_of(r), r.navigator) not in covered]
