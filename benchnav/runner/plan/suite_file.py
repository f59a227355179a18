"""The suite file: the YAML file that describes a run."""

import re
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, field_validator

from benchnav.config.yaml_packages import SUFFIXES, only, suite_files
from benchnav.config.yaml_reader import read_yaml
from benchnav.errors import UsageError, did_you_mean
from benchnav.scenario.catalogue import is_named
from benchnav.scenario.catalogue import names as scenario_names
from benchnav.scenario.parameters import split_parameters
from benchnav.scenario.scenario import Scenario
from benchnav.scenario.terms import Perception, Track
from benchnav.store.runs.spans import SEED_DIGITS

MAX_SEEDS = 1_000_000
_RANGE = re.compile(rf"(?:([0-9]{{1,{SEED_DIGITS}}}):)?([0-9]{{1,{SEED_DIGITS}}})")

Name = Annotated[str, Field(min_length=1, max_length=200)]


class BlockFile(BaseModel):
    """A part of the product; a key that is absent includes all of the suite."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    scenarios: tuple[Name, ...] | None = Field(
        None, min_length=1, description="Some of the suite's scenarios, written as in the suite."
    )
    tracks: tuple[Track, ...] | None = Field(None, min_length=1, description="Some of its tracks.")
    perception: tuple[Perception, ...] | None = Field(
        None, min_length=1, description="Some of its perceptions."
    )
    navigators: tuple[Name, ...] | None = Field(
        None, min_length=1, description="Some of its navigators, by name or label."
    )


class SuiteFile(BaseModel):
    """Scenarios × tracks × perceptions × navigators × seeds."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    name: Annotated[str, Field(pattern=r"^[a-z0-9][a-z0-9-]*$", max_length=60)] = Field(
        description="Name of the suite: small letters, digits and hyphens."
    )
    version: int = Field(
        1, ge=1, description="Increases when the meaning of the suite's results changes."
    )
    description: str = Field("", description="The purpose of the suite.")
    scenarios: tuple[Name, ...] = Field(
        min_length=1, description="Names of scenarios, or paths from this file's folder."
    )
    tracks: tuple[Track, ...] = Field(
        ("known",), min_length=1, description="Knowledge tracks: known, stale, partial, unknown."
    )
    perception: tuple[Perception, ...] = Field(
        ("exact",),
        min_length=1,
        description="Perceptions: exact, and noisy with the key `noise` of each scenario.",
    )
    navigators: tuple[Name | dict[str, Any], ...] = Field(
        min_length=1,
        description="Names, or {type: name, label: its name in tables, …its parameters}.",
    )
    blocks: tuple[BlockFile, ...] = Field(
        (), description="If given, only these parts of the product run."
    )
    seeds: int | str = Field(20, description="N for seeds 0 … N-1, or 'a:b' for seeds a … b-1.")
    split: Literal["train", "validation", "test"] = Field(
        "test", description="The random stream of the worlds."
    )
    undisturbed: bool = Field(
        False,
        description="Whether worlds with background navigators also run once without the"
        " evaluated agents, to measure the disturbance of people.",
    )

    @field_validator("seeds")
    @classmethod
    def _check_seeds(cls, seeds: int | str) -> int | str:
        parse_seeds(str(seeds))
        return seeds


def parse_seeds(text: str) -> range:
    """Return the seeds of a text: ``"20"`` → 0 … 19; ``"100:120"`` → 100 … 119.

    Raises ValueError with the rule and the text.
    """
    rule = (
        f"must be N (seeds 0 … N-1) or A:B (seeds A … B-1), with 1 to {MAX_SEEDS} seeds and at"
        f" most {SEED_DIGITS} digits"
    )
    match = _RANGE.fullmatch(text)
    if match is None:
        raise ValueError(f"{rule}; got {text[:60]!r}")
    first, stop = int(match[1] or 0), int(match[2])
    if not 1 <= stop - first <= MAX_SEEDS:
        raise ValueError(f"{rule}; got {text!r}")
    return range(first, stop)


def suite_names() -> list[str]:
    """Return the names of all installed suites, sorted."""
    return list(suite_files())


def suite_path(name: str) -> Path:
    """Return the file of an installed suite, or the path itself if ``name`` is a path.

    Raises UsageError if it is neither, PluginConflictError if two packages contain the suite.
    """
    if _is_file_name(name):
        return Path(name)
    files = suite_files()
    if name in files:
        return only("suite", files[name]).path
    raise UsageError(
        f"SUITE must be one of the suites {', '.join(suite_names())}, the name of a scenario, or"
        f" a file (*.yaml). Got {name!r} instead."
        f"{did_you_mean(name, [*suite_names(), *scenario_names()])}"
    )


def is_scenario(name: str) -> bool:
    """Whether ``name`` is the name or file of a scenario, and not of a suite.

    Raises ScenarioError if a file cannot be read.
    """
    base, _ = split_parameters(name)
    if _is_file_name(base):
        return describes_scenario(read_yaml(base).data)
    return base not in suite_names() and is_named(name)


def describes_scenario(data: Any) -> bool:
    """Whether the content of a YAML file has more keys of a scenario than of a suite."""
    keys = set(data) if isinstance(data, dict) else set()
    return len(keys & set(Scenario.model_fields)) > len(keys & set(SuiteFile.model_fields))


def _is_file_name(name: str) -> bool:
    return name.endswith(SUFFIXES) or Path(name).is_file()


def json_schema() -> dict[str, Any]:
    """Return the JSON Schema (2020-12) of a suite file."""
    schema = SuiteFile.model_json_schema()
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **schema}
