"""What a run folder says about itself."""

import hashlib
import json
import platform
from collections.abc import Collection, Mapping
from dataclasses import asdict, dataclass, field, replace
from datetime import UTC, datetime
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any, Literal

from benchnav.config.document import Document, Place, shown
from benchnav.config.validation import validate
from benchnav.errors import CorruptPartError, NoRunError, ScenarioError, StoreError
from benchnav.navigation.command_check import short
from benchnav.store.bounded import bounded_json
from benchnav.store.runs import checked_json
from benchnav.store.runs.manifest_schema import ManifestSchema
from benchnav.store.runs.run_path import RunPath, run_path

SCHEMA = 4  # of a run folder; 2: rehearsals; 3: all that verifying needs; 4: navigators' source
MANIFEST = "manifest.json"
MOST_BYTES = 64 << 20  # of a manifest
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
    # labels that ran in the runner's own process, where nothing guards other entries from them
    unguarded: tuple[str, ...] = ()
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
        CorruptPartError: its manifest is damaged, or holds what no run writes.
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
        text = bounded_json.read_text(path, MOST_BYTES)
    except (OSError, ValueError) as error:
        raise CorruptPartError(
            f"{path} must be what was written. It cannot be read: {short(error)}."
        ) from error
    return parse_manifest(text, path)


def parse_manifest(text: str, path: Path) -> Manifest:
    """The manifest that stands in ``path`` as ``text``. Raises as `load_manifest` does."""
    try:
        fields = checked_json.load(text)
        _refuse_newer(path, fields)
        validate(ManifestSchema, Document(str(path), fields, Place(1)))
        manifest = Manifest(
            fields["suite"], tuple(fields["cells"]), fields.get("salt", ""),
            fields.get("limits", {}), fields.get("shard", ""), fields.get("sources", {}),
            tuple(fields.get("unguarded", ())), fields["schema"], fields["versions"],
            fields["platform"], fields["created"],
        )  # fmt: skip
        whole = manifest.suite_hash == fields["suite_hash"]
    except (OSError, ValueError, RecursionError) as error:
        raise CorruptPartError(
            f"{path} must be what was written. It cannot be read: {short(error)}."
        ) from error
    except ScenarioError as error:
        complaint = str(error).partition("\n")[0].removeprefix(f"{path}:1: ")
        raise CorruptPartError(f"{path} must be what was written. {complaint}") from None
    if not whole:
        raise CorruptPartError(f"{path} must be what was written. Its suite was changed.")
    return manifest


def _refuse_newer(path: Path, fields: Mapping[str, Any]) -> None:
    """Raise StoreError where a newer benchnav wrote the manifest."""
    schema, made = fields.get("schema"), fields.get("versions")
    if type(schema) is not int or schema <= SCHEMA:
        return
    version = made.get("benchnav") if isinstance(made, dict) else None
    raise StoreError(
        f"{path}: schema must be at most {SCHEMA}. Got {shown(schema)} instead:"
        f" benchnav {shown(version)} wrote it; install that one."
    )


def _without_files(entry: Mapping[str, Any]) -> dict[str, Any]:
    kept = {key: value for key, value in entry.items() if key != "fingerprint"}
    return {**kept, "leader": _without_files(kept["leader"])} if "leader" in kept else kept
