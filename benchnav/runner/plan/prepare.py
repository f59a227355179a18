"""The start of a run: its manifest, in a new folder or in one of an equal run."""

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from benchnav.errors import RunConflictError, UsageError
from benchnav.processes.process_tree import memory_is_known
from benchnav.runner.plan.contestant import sources_of
from benchnav.runner.plan.job import Job
from benchnav.runner.plan.limits import Limits
from benchnav.runner.plan.shard import Shard
from benchnav.runner.plan.suite import Suite
from benchnav.runner.rollouts.seeding import draw_salt
from benchnav.scenario.condition import EXACT
from benchnav.store.runs.manifest import MANIFEST, Manifest, schema_for
from benchnav.store.runs.provenance import provenance
from benchnav.store.runs.run_folder import RunFolder
from benchnav.store.runs.spans import spans


def refuse_limits(workers: int | None, timeout: float | None, memory: float | None) -> None:
    """Raise UsageError if a limit cannot be enforced on this machine."""
    if workers == 0 and (timeout, memory) != (None, None):
        raise UsageError("A limit must have a worker process to hold in. Got 0 workers.")
    if memory is not None and not memory_is_known():
        raise UsageError(
            "A memory limit is not supported here: process memory cannot be read. Leave it out."
        )


def planned(
    suite: Suite, jobs: list[Job], wanted: Mapping[str, set[int]], shard: Shard | None
) -> Manifest:
    """Return the manifest of a new run of the seeds ``wanted`` of each cell, without limits."""
    stored_cells: list[dict[str, Any]] = [_fields_of_cell(job) for job in jobs]
    if shard is not None:
        for fields in stored_cells:
            fields["seeds"] = spans(wanted.get(fields["key"], ()))
    described = suite.resolved()
    return Manifest(
        described, tuple(stored_cells), suite.salt or draw_salt(), shard=str(shard or ""),
        sources=sources_of(suite.contestants), schema=schema_for(described),
        provenance=provenance(),
    )  # fmt: skip


def start(
    suite: Suite, out: Path, manifest: Manifest, timeout: float | None, memory: float | None
) -> tuple[RunFolder, Limits]:
    """Return the run folder, which is new or found, and its limits.

    Raises UsageError for an invalid limit, and for a new shard without a salt; RunConflictError if
    ``out`` holds a run with another shard, salt or limits; StoreError if the disk cannot be
    written.
    """
    if manifest.shard and not suite.salt and not (out / MANIFEST).exists():
        raise UsageError(
            "A shard must have the salt of the others. Got none: give all the same salt, of up"
            " to 64 bytes in hexadecimal digits that cannot be guessed (openssl rand -hex 16)."
        )
    wanted = _limits(Limits(), timeout, memory)
    folder = RunFolder.start(out, replace(manifest, limits=wanted.fields()))
    if folder.manifest.shard != manifest.shard:
        raise RunConflictError(
            f"{out} must hold {_share(manifest)}. It holds {_share(folder.manifest)}."
            " Choose another folder."
        )
    held = folder.manifest.salt
    if suite.salt not in ("", held):
        raise RunConflictError(
            f"The salt must be that of the run in {folder.path}, {held}. Got {suite.salt} instead."
            " Leave the salt out to continue there, or choose another folder."
        )
    limits = Limits.of(folder.manifest.limits)
    if _limits(limits, timeout, memory) != limits:
        raise RunConflictError(
            f"The limits must be those of the run in {folder.path}, {limits}. Got"
            f" {_limits(limits, timeout, memory)} instead. Leave timeout and memory out to"
            " continue there, or choose another folder."
        )
    return folder, limits


def _share(manifest: Manifest) -> str:
    return f"shard {manifest.shard}" if manifest.shard else "the whole suite"


def _limits(otherwise: Limits, timeout: float | None, memory: float | None) -> Limits:
    try:
        return Limits(
            otherwise.timeout if timeout is None else timeout,
            otherwise.memory if memory is None else memory,
        )
    except ValueError as error:
        raise UsageError(f"The limit {error}.") from None


def _fields_of_cell(job: Job) -> dict[str, Any]:
    return {
        "key": job.key,
        "scenario": job.scenario.identity,
        "track": job.track,
        **({} if job.perception == EXACT else {"perception": job.perception}),
        "navigator": job.contestant.label,
        "reason": job.reason,
        **({"also": list(job.also)} if job.also else {}),
    }
