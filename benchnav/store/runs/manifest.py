"""The manifest: the description of a run in its folder."""

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
from benchnav.store.runs.config_key import RENAMED_IN, new_form, old_form
from benchnav.store.runs.manifest_schema import ManifestSchema
from benchnav.store.runs.run_path import RunPath, run_path

SCHEMA = 9  # of a run folder; 2: rehearsals; 3: all that verifying needs; 4: navigators' source;
#            5: provenance; 6: key `config`; 7: coded states; 8: perceptions;
#            9: undisturbed episodes
_PERCEPTION_SCHEMA = 8  # of runs without undisturbed episodes
_EXACT_SCHEMA = 7  # of runs with exact perception only: older versions can read them
MANIFEST = "manifest.json"
MAX_BYTES = 64 << 20  # of a manifest
UNDISTURBED = "undisturbed"  # label of the cells without evaluated agents; no navigator has it
_RECORDED = ("benchnav", "numpy", "numba", "scipy", "shapely", "pyarrow", "pedpy", "ompl")

Mode = Literal["in-process", "isolated"]  # how a navigator runs
IN_PROCESS: Mode = "in-process"  # also the default of manifests without a mode
ISOLATED: Mode = "isolated"  # in a separate process that receives messages only


@dataclass(frozen=True)
class Manifest:
    """The suite that a run executes, and its conditions."""

    suite: Mapping[str, Any]  # resolved: hashes of scenarios, full configurations, seeds
    # key, scenario, track, navigator, reason for n/a or ""; `also`: other tracks it represents;
    # `perception` unless it is exact
    cells: tuple[Mapping[str, Any], ...]
    salt: str = ""  # of the navigators' random numbers, in hexadecimal digits
    limits: Mapping[str, float] = field(default_factory=dict)  # an episode beyond them fails
    shard: str = ""  # "2/4" if the run executes only this share; its cells then list their seeds
    # label → {hash: of the code that produced the episodes, places: module:attribute of its parts}
    sources: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)
    # labels that ran in the runner's own process, where other entries are not protected from them
    unguarded: tuple[str, ...] = ()
    schema: int = SCHEMA
    versions: Mapping[str, str] = field(default_factory=lambda: versions())
    platform: str = field(default_factory=platform.platform)
    created: str = field(default_factory=lambda: datetime.now(UTC).isoformat(timespec="seconds"))
    # commit, dirty, processor, command: `provenance.provenance`; empty in runs of 0.1
    provenance: Mapping[str, Any] = field(default_factory=dict)

    @property
    def name(self) -> str:
        """The display name: ``quick@1 (3f2a9c01d2e4)``."""
        return f"{self.suite.get('name')}@{self.suite.get('version')} ({self.suite_hash[:12]})"

    @property
    def suite_hash(self) -> str:
        """The sha256 of the resolved suite; only runs with equal hashes may share a folder.

        It is computed with the old name of the key `config`, so that old runs keep their hash.
        """
        text = json.dumps(old_form(self.suite), sort_keys=True, separators=(",", ":"))
        return hashlib.sha256(text.encode()).hexdigest()

    @property
    def plan(self) -> dict[str, Any]:
        """The suite without file fingerprints, which count as source."""
        navigators = [_without_files(entry) for entry in self.suite.get("navigators", ())]
        return {**self.suite, "navigators": navigators}

    def source_of(self, label: str) -> str:
        """Return the source hash of a navigator; "" if the run does not have it."""
        return str(self.sources.get(label, {}).get("hash", ""))

    def files_of(self, label: str) -> list[str]:
        """Return the fingerprints of files that a navigator and its leader read."""
        entry: Mapping[str, Any] = next(
            (e for e in self.suite.get("navigators", ()) if e["label"] == label), {}
        )
        return [str(e.get("fingerprint", "")) for e in (entry, entry.get("leader", {}))]

    def is_undisturbed(self, cell: Mapping[str, Any]) -> bool:
        """Whether a cell holds undisturbed episodes, and none of a navigator."""
        return "undisturbed" in self.suite and cell.get("navigator") == UNDISTURBED

    def with_sources_of(self, other: "Manifest", labels: Collection[str]) -> "Manifest":
        """Return this manifest with the sources of ``labels`` from ``other``."""
        others = {e["label"]: e for e in other.suite.get("navigators", ())}
        entries = self.suite.get("navigators", ())
        merged = [others[e["label"]] if e["label"] in labels else e for e in entries]
        sources = {k: v for k, v in other.sources.items() if k in labels}
        return replace(
            self, suite={**self.suite, "navigators": merged}, schema=schema_for(self.suite),
            sources={**self.sources, **sources},
        )  # fmt: skip

    def dump(self) -> str:
        """Return the JSON text of `MANIFEST`."""
        fields = {**asdict(self), "suite_hash": self.suite_hash}
        if self.schema < RENAMED_IN:
            fields["suite"] = old_form(fields["suite"])
        return checked_json.dump(fields)


def schema_for(suite: Mapping[str, Any]) -> int:
    """Return the schema of a new run of a resolved suite."""
    if "undisturbed" in suite:
        return SCHEMA
    return _PERCEPTION_SCHEMA if "perception" in suite else _EXACT_SCHEMA


def versions() -> dict[str, str]:
    """Return the versions of installed packages that can influence results."""
    found = {"python": platform.python_version()}
    for name in _RECORDED:
        try:
            found[name] = version(name)
        except PackageNotFoundError:
            continue
    return found


def load_manifest(run: RunPath) -> Manifest:
    """Return the manifest of a run folder.

    Raises:
        NoRunError: the folder is not a run.
        StoreError: a newer benchnav wrote it.
        CorruptPartError: its manifest is damaged, or has content that no run writes.
    """
    run = run_path(run)
    path = run / MANIFEST
    if not path.is_file():
        problem = "Got a file" if run.is_file() else "It does not exist" if not run.exists() else ""
        raise NoRunError(
            f"{run} must be a run folder, with a {MANIFEST}."
            f" {problem or 'It has none'}. Running a suite creates one."
        )
    try:
        text = bounded_json.read_text(path, MAX_BYTES)
    except (OSError, ValueError) as error:
        raise CorruptPartError(f"{path} is damaged. It cannot be read: {short(error)}.") from error
    return parse_manifest(text, path)


def parse_manifest(text: str, path: Path) -> Manifest:
    """Return the manifest in ``text`` of the file ``path``. Raises like `load_manifest`."""
    try:
        fields = checked_json.load(text)
        _refuse_newer(path, fields)
        if _is_old(fields.get("schema")):
            fields["suite"] = new_form(fields.get("suite"))
        validate(ManifestSchema, Document(str(path), fields, Place(1)))
        manifest = Manifest(
            fields["suite"], tuple(fields["cells"]), fields.get("salt", ""),
            fields.get("limits", {}), fields.get("shard", ""), fields.get("sources", {}),
            tuple(fields.get("unguarded", ())), fields["schema"], fields["versions"],
            fields["platform"], fields["created"], fields.get("provenance", {}),
        )  # fmt: skip
        whole = manifest.suite_hash == fields["suite_hash"]
    except (OSError, ValueError, RecursionError) as error:
        raise CorruptPartError(f"{path} is damaged. It cannot be read: {short(error)}.") from error
    except ScenarioError as error:
        complaint = str(error).partition("\n")[0].removeprefix(f"{path}:1: ")
        raise CorruptPartError(f"{path} is damaged. {complaint}") from None
    if not whole:
        raise CorruptPartError(f"{path} is damaged. Its suite was changed.")
    return manifest


def _refuse_newer(path: Path, fields: Mapping[str, Any]) -> None:
    """Raise StoreError if a newer benchnav wrote the manifest."""
    schema, made = fields.get("schema"), fields.get("versions")
    if type(schema) is not int or schema <= SCHEMA:
        return
    version = made.get("benchnav") if isinstance(made, dict) else None
    raise StoreError(
        f"{path}: schema must be at most {SCHEMA}. Got {shown(schema)} instead:"
        f" benchnav {shown(version)} wrote it; install that version."
    )


def _is_old(schema: object) -> bool:
    return type(schema) is int and schema < RENAMED_IN


def _without_files(entry: Mapping[str, Any]) -> dict[str, Any]:
    kept = {key: value for key, value in entry.items() if key != "fingerprint"}
    return {**kept, "leader": _without_files(kept["leader"])} if "leader" in kept else kept
