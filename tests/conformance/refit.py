"""Makes everything in a changed run fit again, as an attacker would who knows the format."""

import hashlib
import json
from pathlib import Path
from tempfile import TemporaryDirectory

import pyarrow as pa
import pyarrow.parquet as pq

from benchnav.errors import BenchnavError
from benchnav.runner.plan.job import Job
from benchnav.store.parts.part import FILES, SEAL
from benchnav.store.runs import checked_json
from benchnav.store.runs.config_key import old_form
from benchnav.store.runs.manifest import MANIFEST
from benchnav.store.runs.run_folder import RunFolder
from benchnav.verify.finding import Report
from benchnav.verify.rebuilt_suite import restore


def refit_seal(stem: str) -> None:
    """Let the seal of a part be that of its files."""
    content = {}
    for suffix in FILES:
        path = Path(stem + suffix)
        if path.exists():
            data = path.read_bytes()
            content[suffix] = {"bytes": len(data), "sha256": hashlib.sha256(data).hexdigest()}
    first, stop = map(int, Path(stem).name.split("-"))
    content["episodes"] = stop - first
    Path(stem + SEAL).write_text(checked_json.dump(content))


def refit_manifest(run: Path, content: dict, attacked: str) -> None:
    """Write a changed manifest, with the hashes, cells, folders and rows that follow from it."""
    before = RunFolder.open(run)
    write_manifest(run, content)
    if not attacked.startswith(("suite.", "sources")):
        return
    try:
        cells = _cells(run, content)
    except (BenchnavError, KeyError, TypeError, ValueError, AttributeError, StopIteration):
        return
    folders = [before.cell(cell["key"]) for cell in before.manifest.cells]
    if len(cells) != len(folders):
        return
    for said, cell in zip(content["cells"], cells, strict=True):
        said |= {
            "key": cell.key, "scenario": cell.scenario.identity, "track": cell.track,
            "navigator": cell.contestant.label,
        }  # fmt: skip
    write_manifest(run, content)
    after = RunFolder.open(run)
    for old, cell in zip(folders, cells, strict=True):
        new = after.cell(cell.key)
        if old.is_dir():
            old.rename(new)
            _relabel(new, cell)


def write_manifest(run: Path, content: dict) -> None:
    """Write a manifest with checksums that fit."""
    content.pop("sha256", None)
    text = json.dumps(old_form(content.get("suite")), sort_keys=True, separators=(",", ":"))
    content["suite_hash"] = hashlib.sha256(text.encode()).hexdigest()
    (run / MANIFEST).write_text(checked_json.dump(content))


def _cells(run: Path, content: dict) -> list[Job]:
    """The cells of the changed suite; hashes of scenarios are made to fit first."""
    for _ in range(2):
        report = Report()
        with TemporaryDirectory() as root:
            restored = restore(RunFolder.open(run), Path(root), report)
        wrong = [f for f in report.findings if f.kind == "scenario" and "has the hash" in f.what]
        for finding in wrong:
            said = next(s for s in content["suite"]["scenarios"] if s["scenario"] == finding.where)
            said["hash"] = finding.what.split("has the hash ")[1].split(",")[0]
        if restored is not None and not wrong:
            return list(restored.jobs)
        write_manifest(run, content)
    raise ValueError("the suite cannot be restored")


def _relabel(folder: Path, cell: Job) -> None:
    """Let every row say that it is of ``cell``."""
    who = cell.assignment.identity(0)
    own = {
        name: getattr(who, name)
        for name in ("scenario", "scenario_hash", "split", "track", "navigator",
                     "navigator_hash", "source_hash")
    }  # fmt: skip
    for seal in folder.glob(f"*{SEAL}"):
        stem = str(seal).removesuffix(SEAL)
        for suffix in FILES:
            if not Path(stem + suffix).exists():
                continue
            table = pq.read_table(stem + suffix)
            for name, value in own.items():
                place = table.column_names.index(name)
                column = pa.array([value] * len(table), pa.string())
                table = table.set_column(place, name, column)
            pq.write_table(table, stem + suffix)
        refit_seal(stem)
