"""What a run folder says about itself."""

import hashlib
import json
import platform
import re
from collections.abc import Collection, Mapping, Sequence
from dataclasses import asdict, dataclass, field, fields, replace
from datetime import UTC, datetime
from importlib.metadata import PackageNotFoundError, version
from typing import Any, Literal

from benchnav.errors import CorruptPartError, NoRunError, StoreError
from benchnav.store import checked_json
from benchnav.store.run_path import RunPath, run_path
from benchnav.store.spans import SEED_END

SCHEMA = 4  # of a run folder; 2: rehearsals; 3: all that verifying needs; 4: navigators' source
MANIFEST = "manifest.json"
_KEY = re.compile(r"[A-Za-z0-9@_-][A-Za-z0-9@._-]{0,250}")  # of a cell: the name of its folder
_SOURCE = re.compile(r"[0-9a-f]{16}")
_OF_A_CELL = ("key", "scenario", "track", "navigator", "reason")
_RECORDED = ("benchnav", "numpy", "numba", "scipy", "shapely", "pyarrow", "pedpy", "ompl")

Mode = Literal["in-process", "isolated"]  # of a navigator; what a manifest says of it
IN_PROCESS: Mode = "in-process"  # also where nothing is said
ISOLATED: Mode = "isolated"  # in a process of its own that is told what messages say


@dataclass(frozen=True)
class Manifest:
    """The suite that a run executes, and with what."""

    suite: Mapping[str, Any]  # resolved: hashes of scenarios, full configurations, seeds
    # key, scenario, track, navigator, reason it is n/a or ""; also: other tracks it stands for
    cells: tuple[Mapping[str, Any], ...]
    salt: str = ""  # of the randomness that navigators are handed, in hexadecimal digits
    limits: Mapping[str, float] = field(default_factory=dict)  # beyond which an episode fails
    shard: str = ""  # "2/4" where it executes that share alone; its cells then say their seeds
    # label → {hash: of the code that made the episodes, places: module:attribute of its parts}
    sources: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)
    schema: int = SCHEMA
    versions: Mapping[str, str] = field(default_factory=lambda: versions())
    platform: str = field(default_factory=platform.platform)
    created: str = field(default_factory=lambda: datetime.now(UTC).isoformat(timespec="seconds"))

    @property
    def name(self) -> str:
        """For people: ``quick@1 (3f2a9c01d2e4)``."""
        return f"{self.suite.get('name')}@{self.suite.get('version')} ({self.suite_hash[:12]})"

    @property
    def suite_hash(self) -> str:
        """sha256 of the resolved suite: runs that may share a folder share it."""
        text = json.dumps(self.suite, sort_keys=True, separators=(",", ":"))
        return hashlib.sha256(text.encode()).hexdigest()

    @property
    def plan(self) -> dict[str, Any]:
        """The suite without the fingerprints of files, which count as source."""
        navigators = [_without_files(entry) for entry in self.suite.get("navigators", ())]
        return {**self.suite, "navigators": navigators}

    def source_of(self, label: str) -> str:
        """Return the hash of the source of a navigator; "" where the run does not say it."""
        return str(self.sources.get(label, {}).get("hash", ""))

    def files_of(self, label: str) -> list[str]:
        """Return the fingerprints of what a navigator and its leader read."""
        entry: Mapping[str, Any] = next(
            (e for e in self.suite.get("navigators", ()) if e["label"] == label), {}
        )
        return [str(e.get("fingerprint", "")) for e in (entry, entry.get("leader", {}))]

    def with_sources_of(self, other: "Manifest", labels: Collection[str]) -> "Manifest":
        """Return this with the code of ``labels`` as ``other`` says it."""
        theirs = {e["label"]: e for e in other.suite.get("navigators", ())}
        entries = self.suite.get("navigators", ())
        mine = [theirs[e["label"]] if e["label"] in labels else e for e in entries]
        sources = {k: v for k, v in other.sources.items() if k in labels}
        return replace(
            self, suite={**self.suite, "navigators": mine}, schema=SCHEMA,
            sources={**self.sources, **sources},
        )  # fmt: skip

    def dump(self) -> str:
        """JSON for `MANIFEST`."""
        return checked_json.dump({**asdict(self), "suite_hash": self.suite_hash})


_SAID = {part.name for part in fields(Manifest)} | {"suite_hash"}


def versions() -> dict[str, str]:
    """Installed packages that have a say in the numbers, and their versions."""
    found = {"python": platform.python_version()}
    for name in _RECORDED:
        try:
            found[name] = version(name)
        except PackageNotFoundError:
            continue
    return found


def load_manifest(run: RunPath) -> Manifest:
    """The manifest of a run folder.

    Raises:
        NoRunError: the folder is no run.
        StoreError: a newer benchnav wrote it.
        CorruptPartError: its manifest is damaged, or names a cell that no folder may be called.
    """
    run = run_path(run)
    path = run / MANIFEST
    if not path.is_file():
        what = "Got a file" if run.is_file() else "It is not there" if not run.exists() else None
        raise NoRunError(
            f"{run} must be a run folder, with a {MANIFEST}."
            f" {what or 'It has none'}. 'benchnav run SUITE --out {run}' makes one."
        )
    try:
        said = checked_json.load(path.read_text(encoding="utf-8"), _SAID)
        schema = said["schema"]
        if isinstance(schema, int) and schema > SCHEMA:
            raise StoreError(
                f"{path}: schema must be at most {SCHEMA}. Got {schema} instead:"
                f" benchnav {said['versions'].get('benchnav')} wrote it; install that one."
            )
        manifest = Manifest(
            said["suite"], tuple(said["cells"]), said.get("salt", ""), said.get("limits", {}),
            said.get("shard", ""), said.get("sources", {}), schema, said["versions"],
            said["platform"], said["created"],
        )  # fmt: skip
        whole = manifest.suite_hash == said["suite_hash"]
        _refuse_strange_cells(manifest.cells)
        _refuse_strange_sources(manifest.sources)
    except (OSError, ValueError, KeyError, TypeError, AttributeError, RecursionError) as error:
        raise CorruptPartError(
            f"{path} must be what was written. It cannot be read: {error}."
        ) from error
    if not whole:
        raise CorruptPartError(f"{path} must be what was written. Its suite was changed.")
    return manifest


def _without_files(entry: Mapping[str, Any]) -> dict[str, Any]:
    kept = {key: value for key, value in entry.items() if key != "fingerprint"}
    return {**kept, "leader": _without_files(kept["leader"])} if "leader" in kept else kept


def _refuse_strange_sources(sources: Mapping[str, Any]) -> None:
    """Raise ValueError: hashes become part of paths, and places are looked for."""
    for label, source in sources.items():
        if not _SOURCE.fullmatch(source["hash"]):
            raise ValueError(f"sources[{label!r}].hash must be a hash; got {source['hash']!r}")
        if not all(isinstance(place, str) for place in source["places"]):
            raise ValueError(f"sources[{label!r}].places must be a list of texts")


def _refuse_strange_cells(cells: Sequence[Mapping[str, Any]]) -> None:
    """Raise ValueError: keys become paths, and what a stranger wrote must not lead elsewhere."""
    for i, cell in enumerate(cells):
        if not _KEY.fullmatch(cell["key"]):
            raise ValueError(f"cells[{i}].key must be the name of a folder; got {cell['key']!r}")
        strange = [name for name in _OF_A_CELL if not isinstance(cell.get(name, ""), str)]
        if strange:
            raise ValueError(f"cells[{i}].{strange[0]} must be text")
        for span in cell.get("seeds", ()):
            first, stop = map(int, span)
            if not 0 <= first < stop <= SEED_END:
                raise ValueError(f"cells[{i}].seeds must be spans; got {span}")
