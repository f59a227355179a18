"""A scenario: what a YAML file describes, and what worlds are drawn from."""

from os import PathLike
from typing import TYPE_CHECKING

from benchnav.api.output.text_table import key_value_html
from benchnav.scenario.catalogue import find
from benchnav.scenario.parameters import Value, joined_parameters, split_parameters, written
from benchnav.scenario.scenario import Scenario as Record
from benchnav.text.plural import counted

if TYPE_CHECKING:
    from benchnav.api.records.world import World


def load_scenario(name: "str | PathLike[str]", **parameters: Value) -> "Scenario":
    """Load a scenario by name or from a YAML file, with parameters other than the default.

    For example ``load_scenario("trap/u", mouth=2)``, which is ``trap/u:mouth=2`` elsewhere.

    Raises:
        UnknownPluginError: there is no scenario of this name.
        UsageError: it has no such parameter, or the value is not allowed.
        ScenarioError: the file is wrong; each line begins with file:line: key.
    """
    base, given = split_parameters(str(name))
    return Scenario(base + joined_parameters({**given, **parameters}))


class Scenario:
    """A validated scenario. `world` draws worlds from it."""

    def __init__(self, name: str) -> None:
        self.name = name  # as `benchnav.run` takes it
        self.record: Record = find(name)  # the plain record

    @property
    def identity(self) -> str:
        """Name, version, and parameters that are not the default: ``trap/u@1:mouth=2``."""
        return self.record.identity

    @property
    def title(self) -> str:
        """The title: one line of text."""
        return self.record.title

    @property
    def hash(self) -> str:
        """16 hexadecimal digits of everything that decides the worlds."""
        return self.record.hash

    @property
    def tracks(self) -> tuple[str, ...]:
        """The knowledge tracks in which it can be run."""
        return self.record.granted_tracks

    @property
    def parameters(self) -> dict[str, Value]:
        """The parameters and their values."""
        chosen = split_parameters(self.identity)[1]
        return {name: chosen.get(name, p.default) for name, p in self.record.parameters.items()}

    def world(self, seed: int = 0, split: str = "test") -> "World":
        """Draw the world of a seed, which is the same on every machine.

        Raises UnsolvableError where no solvable world is found, UsageError for a negative seed
        or an unknown split (train, validation, test).
        """
        from benchnav.api.records.world import World
        from benchnav.generation.build import build

        return World(build(self.record, split, seed), self, split, seed)

    def _facts(self) -> list[tuple[str, str]]:
        x0, y0, x1, y1 = self.record.bounds
        ranges = (
            f"{name} = {written(value)} ({p.allowed})"
            for (name, value), p in zip(
                self.parameters.items(), self.record.parameters.values(), strict=True
            )
        )
        return [
            ("title", self.title),
            ("arena", f"{x1 - x0:g} m × {y1 - y0:g} m"),
            ("teams", ", ".join(dict.fromkeys(team.name for team in self.record.teams))),
            ("tracks", ", ".join(self.tracks)),
            ("parameters", ", ".join(ranges) or "none"),
            ("hash", self.hash),
        ]

    def __repr__(self) -> str:
        teams = counted(len({team.name for team in self.record.teams}), "team")
        return f"Scenario({self.identity!r}: {self.title}; {teams})"

    def _repr_html_(self) -> str:
        return key_value_html(f"Scenario {self.identity}", self._facts())
