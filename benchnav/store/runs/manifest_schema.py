"""The schema of a manifest: types, ranges and lengths of every key.

The descriptions of scenarios and navigators are bounded by the size of the file only; they are
checked where they are used.
"""

from collections.abc import Sequence
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, model_validator

from benchnav.config.document import shown
from benchnav.config.validation import FieldError
from benchnav.scenario.parameters import Parameter
from benchnav.scenario.terms import Perception, Track
from benchnav.store.runs.provenance import LONGEST
from benchnav.store.runs.spans import SEED_END

MAX_SEEDS = 1_000_000  # of a run
MOST_CELLS = 1_000_000
_FAR = 1e15  # [s] of training

Label = Annotated[str, Field(min_length=1, max_length=200)]
Hex16 = Annotated[str, Field(pattern=r"^[0-9a-f]{16}$")]
Hex64 = Annotated[str, Field(pattern=r"^[0-9a-f]{64}$")]
Identity = Annotated[str, Field(min_length=1, max_length=2_000)]
Seed = Annotated[int, Field(ge=0, le=SEED_END)]
Span = Annotated[tuple[Seed, Seed], Field(description="first, stop")]
Short = Annotated[str, Field(max_length=200)]
Text = Annotated[str, Field(max_length=10_000)]
Perceptions = Annotated[tuple[Perception, ...], Field(min_length=1, max_length=2)]


class _Part(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)


class _ScenarioConfig(BaseModel):
    """A scenario's own description; it is fully checked where its worlds are drawn."""

    model_config = ConfigDict(extra="allow", frozen=True)

    parameters: dict[Short, Parameter] = {}


class _Scenario(_Part):
    scenario: Identity
    hash: Short
    config: _ScenarioConfig
    files: dict[Annotated[str, Field(max_length=500)], Hex64] = {}


class _Training(_Part):
    decisions: Annotated[int, Field(ge=0, le=1 << 62)]
    seconds: Annotated[float, Field(ge=0, le=_FAR)]


class _Entry(_Part):
    label: Label
    config: dict[str, Any]
    source: Text
    mode: Literal["in-process", "isolated"] = "in-process"
    training: _Training | None = None
    uses_map: bool = True
    fingerprint: Short = ""


class _Navigator(_Entry):
    rehearsal: Annotated[int, Field(ge=0, le=1_000_000)] = 0
    leader: _Entry | None = None


class _Block(_Part):
    scenarios: Annotated[tuple[Identity, ...], Field(max_length=10_000)]
    tracks: Annotated[tuple[Track, ...], Field(max_length=4)]
    navigators: Annotated[tuple[Label, ...], Field(max_length=10_000)]
    perception: Perceptions = ("exact",)


class _Suite(_Part):
    name: Short
    version: Annotated[int, Field(ge=1, le=1 << 31)]
    split: Literal["train", "validation", "test"]
    seeds: Span
    scenarios: Annotated[tuple[_Scenario, ...], Field(max_length=100_000)]
    tracks: Annotated[tuple[Track, ...], Field(max_length=4)]
    perception: Perceptions = ("exact",)
    navigators: Annotated[tuple[_Navigator, ...], Field(max_length=10_000)]
    blocks: Annotated[tuple[_Block, ...], Field(max_length=100)] = ()
    undisturbed: bool = False

    @model_validator(mode="after")
    def _check(self) -> "_Suite":
        first, stop = self.seeds
        if not 1 <= stop - first <= MAX_SEEDS:
            raise FieldError(
                ("seeds",), f"must be [first, stop] of 1 to {MAX_SEEDS} seeds; got {self.seeds}"
            )
        conditions = len(self.tracks) * len(self.perception)
        product = len(self.scenarios) * conditions * len(self.navigators)
        if product > MOST_CELLS:
            raise FieldError((), f"must have at most {MOST_CELLS} cells; it has {product}")
        _require_once(("scenarios",), [s.scenario for s in self.scenarios])
        labels = [n.label for n in self.navigators]
        _require_once(("navigators",), [*labels, *(["undisturbed"] if self.undisturbed else [])])
        return self


class _Cell(_Part):
    key: Annotated[str, Field(pattern=r"^[A-Za-z0-9@_-][A-Za-z0-9@._-]{0,250}$")]
    reason: Text
    scenario: Identity
    track: Track
    perception: Perception = "exact"
    navigator: Label
    also: Annotated[tuple[Track, ...], Field(max_length=3)] = ()
    seeds: Annotated[tuple[Span, ...] | None, Field(max_length=100_000)] = None

    @model_validator(mode="after")
    def _check(self) -> "_Cell":
        end = -1
        for i, (first, stop) in enumerate(self.seeds or ()):
            if not end < first < stop:
                raise FieldError(
                    ("seeds", i), f"must be [first, stop] behind the one before; got {first, stop}"
                )
            end = stop
        return self


class _Limits(_Part):
    timeout_seconds: Annotated[float, Field(gt=0, le=1e6)] = 300.0
    memory_gigabytes: Annotated[float, Field(gt=0, le=1e6)] = 4.0


class _Source(_Part):
    hash: Hex16
    places: Annotated[tuple[Annotated[str, Field(max_length=1_000)], ...], Field(max_length=1_000)]


class _Provenance(_Part):
    commit: Annotated[str, Field(pattern=r"^([0-9a-f]{40}|[0-9a-f]{64})?$")] = ""
    dirty: bool = False
    processor: Short = ""
    command: Annotated[str, Field(max_length=LONGEST)] = ""


class ManifestSchema(_Part):
    """A manifest of any schema so far; keys missing in older ones have a default here."""

    suite: _Suite
    cells: Annotated[tuple[_Cell, ...], Field(max_length=MOST_CELLS)]
    salt: Annotated[str, Field(pattern=r"^([0-9a-f]{2}){0,64}$")] = ""
    limits: _Limits = _Limits()
    shard: Annotated[str, Field(pattern=r"^([0-9]{1,9}/[0-9]{1,9})?$")] = ""
    sources: dict[Label, _Source] = {}
    unguarded: Annotated[
        tuple[Annotated[str, Field(max_length=80)], ...], Field(max_length=10_000)
    ] = ()
    schema_: Annotated[int, Field(alias="schema", ge=1)]
    versions: dict[Short, Short]
    platform: Annotated[str, Field(max_length=1_000)]
    created: Short
    provenance: _Provenance = _Provenance()
    suite_hash: Hex64

    @model_validator(mode="after")
    def _check(self) -> "ManifestSchema":
        _require_once(("cells",), [cell.key for cell in self.cells])
        _require_once(
            ("cells",), [(c.scenario, c.track, c.perception, c.navigator) for c in self.cells]
        )
        first, stop = self.suite.seeds
        for i, cell in enumerate(self.cells):
            if cell.seeds and not (first <= cell.seeds[0][0] and cell.seeds[-1][1] <= stop):
                raise FieldError(
                    ("cells", i, "seeds"), f"must be among those of the suite, {first} to {stop}"
                )
        return self


def _require_once(path: tuple[str, ...], names: Sequence[object]) -> None:
    """Raise FieldError if a name occurs twice."""
    earlier: set[object] = set()
    for i, name in enumerate(names):
        if name in earlier:
            raise FieldError((*path, i), f"must not repeat {shown(name)}")
        earlier.add(name)
