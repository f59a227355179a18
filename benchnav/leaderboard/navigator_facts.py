"""Facts about the navigators of runs that tables show: mode, training and use of maps."""

from collections.abc import Collection, Iterator, Mapping, Sequence
from statistics import fmean
from typing import Any

import pyarrow as pa

from benchnav.leaderboard.marks import labels_of
from benchnav.navigation.plugin.trainings import entries_of, entry_of, labels_of_entry
from benchnav.store.runs.manifest import IN_PROCESS
from benchnav.store.runs.run_folder import RunFolder

Facts = dict[str, Mapping[str, Any]]
"""Label or entry → mode, uses_map, and training (decisions, seconds) if it learned."""


def facts_in(folders: Sequence[RunFolder], tables: Sequence[pa.Table]) -> Facts:
    """Return label → the facts about it, for the labels with rows."""
    facts = Facts()
    for folder, rows in zip(folders, tables, strict=True):
        facts |= _facts(folder, labels_of(rows))
    return facts


def _facts(folder: RunFolder, labels: Collection[str]) -> Facts:
    """The mode, training (decisions, seconds) and use of maps of each navigator."""
    found: Facts = {}
    for entry in folder.manifest.suite.get("navigators", ()):
        if entry["label"] not in labels:
            continue
        facts: dict[str, Any] = {
            "mode": entry.get("mode", IN_PROCESS), "uses_map": entry.get("uses_map") is not False,
        }  # fmt: skip
        if "training" in entry:
            facts["training"] = entry["training"]["decisions"], entry["training"]["seconds"]
        found[entry["label"]] = facts
    return found


def facts_of_entries(found: Mapping[str, Mapping[str, Any]]) -> Facts:
    """Return the facts by entry: the training is the mean over its trainings."""
    entries: Facts = {}
    for entry in entries_of(found):
        each = [found[label] for label in labels_of_entry(entry, found)]
        costs = [facts["training"] for facts in each if "training" in facts]
        mean = {"training": tuple(map(fmean, zip(*costs, strict=True)))} if costs else {}
        entries[entry] = {
            "mode": ", ".join(dict.fromkeys(str(facts["mode"]) for facts in each)),
            "uses_map": any(facts["uses_map"] for facts in each), **mean,
        }  # fmt: skip
    return entries


def entries_of_all(chosen: Collection[str], labels: Collection[str]) -> set[str]:
    """Return the entries all of whose labels are chosen."""
    return {e for e in entries_of(chosen) if {*labels_of_entry(e, labels)} <= {*chosen}}


def trained_in(folder: RunFolder) -> Iterator[str]:
    """Yield the labels and entries of navigators that were trained."""
    for entry in folder.manifest.suite.get("navigators", ()):
        if "training" in entry:
            yield from (entry["label"], entry_of(entry["label"]))
