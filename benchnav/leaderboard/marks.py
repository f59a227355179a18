"""Which labels of a table are marked as verified: by the rows that the table counts."""

from collections.abc import Sequence

import pyarrow as pa

from benchnav.store.runs.run_folder import RunFolder


def labels_of(results: pa.Table) -> set[str]:
    """Return the labels that rows of `benchnav.store.parts.results.RESULTS` hold."""
    return set(results["navigator"].unique().to_pylist())


def marked(
    folders: Sequence[RunFolder], tables: Sequence[pa.Table], verified: Sequence[bool]
) -> set[str]:
    """Return the labels all of whose rows come from runs that were verified here.

    ``tables`` are the results of each of ``folders``, and ``verified`` contains whether
    exactly these results were verified; empty if none were. A label that ran
    unguarded in any run is never marked.
    """
    good: dict[str, bool] = {}
    checks = verified or [False] * len(folders)
    for folder, results, checked in zip(folders, tables, checks, strict=True):
        for label in labels_of(results):
            guarded = label not in folder.manifest.unguarded
            good[label] = good.get(label, True) and checked and guarded
    return {label for label, value in good.items() if value}
