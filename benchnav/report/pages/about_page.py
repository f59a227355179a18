"""The page about the report: where its numbers come from, verification, and how to cite."""

from __future__ import annotations

import shlex
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from datetime import datetime
from typing import Any

from benchnav.report.citation import PAPER, software
from benchnav.report.page import ABOUT, ASSETS, Page, href
from benchnav.report.report_data import ReportData
from benchnav.report.template import fill
from benchnav.runner.plan.limits import Limits
from benchnav.store.runs.manifest import IN_PROCESS, Manifest
from benchnav.store.runs.pinned_run import pinned_digest
from benchnav.store.runs.receipt import verified_at
from benchnav.store.runs.run_folder import RunFolder
from benchnav.store.runs.spans import count


@dataclass(frozen=True)
class RunFacts:
    """The facts about a run."""

    name: str
    facts: tuple[tuple[str, str], ...]
    verification: str
    verify: str  # the command that verifies it
    navigators: tuple[tuple[str, str, str, str], ...]  # label, package, mode, source hash
    scenarios: tuple[tuple[str, str], ...]  # identity, hash


def pages(data: ReportData, made: datetime) -> Iterator[Page]:
    """Yield the page; ``made`` is the time of the report."""
    verified = set(data.values.verified)
    body = fill(
        "about.html",
        page=ABOUT, runs=[_facts(folder, verified) for folder in data.folders],
        caveats=data.board.caveats, made=made.isoformat(timespec="minutes"),
        software=software(str(made.year)), paper=PAPER,
        copy=href(ABOUT, ASSETS / "copy.js"),
    )  # fmt: skip
    yield Page(ABOUT, "How this report was made", body, ABOUT)


def _facts(folder: RunFolder, verified: set[str]) -> RunFacts:
    manifest = folder.manifest
    suite = manifest.suite
    return RunFacts(
        name=f"{suite['name']}@{suite['version']}",
        facts=tuple((key, text) for key, text in _lines(folder, manifest) if text),
        verification=_verification(folder, verified),
        verify=shlex.join(["benchnav", "verify", str(folder.shown)]),
        navigators=tuple(
            (
                str(e["label"]), str(e.get("source", "")), str(e.get("mode", IN_PROCESS)),
                manifest.source_of(str(e["label"])),
            )
            for e in suite["navigators"]
        ),
        scenarios=tuple((str(e["scenario"]), str(e["hash"])) for e in suite["scenarios"]),
    )  # fmt: skip


def _lines(folder: RunFolder, manifest: Manifest) -> Iterator[tuple[str, str]]:
    suite, origin = manifest.suite, manifest.provenance
    total = sum(count(seeds) for _, seeds in folder.planned())
    missing = sum(count(seeds) for _, seeds in folder.missing())
    yield "run", str(folder.shown)
    yield "command", str(origin.get("command", ""))
    yield "begun", manifest.created
    yield "episodes", f"{total - missing} of {total}"
    yield "seeds", f"{suite['seeds'][0]} to {suite['seeds'][1] - 1}, split {suite['split']}"
    yield "tracks", ", ".join(map(str, suite["tracks"]))
    yield "perception", ", ".join(suite.get("perception", ()))
    yield "commit of benchnav", _commit(origin)
    yield "processor", str(origin.get("processor", ""))
    yield "system", manifest.platform
    yield "versions", ", ".join(f"{name} {text}" for name, text in manifest.versions.items())
    yield "limits of an episode", str(Limits.of(manifest.limits)) if manifest.limits else ""
    yield "shard", manifest.shard
    yield "salt of random numbers", manifest.salt
    yield "hash of the suite", manifest.suite_hash
    yield "content (sha256)", pinned_digest(folder) if folder.sums else ""


def _commit(origin: Mapping[str, Any]) -> str:
    commit = str(origin.get("commit", ""))
    return f"{commit}, with changes that were not committed" if origin.get("dirty") else commit


def _verification(folder: RunFolder, verified: set[str]) -> str:
    labels = [str(e["label"]) for e in folder.manifest.suite["navigators"]]
    marked = [label for label in labels if label in verified]
    if not marked:
        return "This run was not verified on the machine that made the report."
    when = verified_at(pinned_digest(folder))
    words = f"Verified on the machine that made the report, {when}: " if when else "Verified: "
    rest = [label for label in labels if label not in verified]
    without = f" Not verified: {', '.join(rest)}." if rest else ""
    return (
        f"{words}worlds were drawn again, commands were simulated again, and metrics were measured"
        f" again.{without}"
    )
