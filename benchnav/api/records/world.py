"""A world: the geometry and the agents of one episode, before it starts."""

from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING

from benchnav.arena.world import World as Record
from benchnav.errors import UsageError
from benchnav.text.plural import counted

if TYPE_CHECKING:
    from benchnav.api.records.scenario import Scenario


class World:
    """A world that `Scenario.world` drew. `benchnav.simulate` runs a navigator in it."""

    def __init__(self, record: Record, scenario: "Scenario", split: str, seed: int) -> None:
        self.record = record  # the plain record: geometry, agents, rules
        self.scenario = scenario
        self.split = split
        self.seed = seed

    def __len__(self) -> int:
        return len(self.record.agents)

    def svg(self) -> str:
        """Return a picture of it as SVG text."""
        from benchnav.viewer.svg import world_svg

        return world_svg(self.record)

    def plot(self, path: "str | PathLike[str]") -> None:
        """Write a figure of it to ``path``, which ends in .png, .svg or .pdf.

        Raises UsageError for another ending, MissingExtraError if matplotlib is not installed.
        """
        from benchnav.viewer.picture import SUFFIXES, is_picture, save
        from benchnav.viewer.scene_figure import world_figure

        target = Path(path)
        if not is_picture(target):
            raise UsageError(f"A picture must end in {', '.join(SUFFIXES)}. Got {target} instead.")
        save(world_figure(self.record), target)

    def __repr__(self) -> str:
        sizes = (
            counted(len(self), "agent"), counted(len(self.record.solids), "solid"),
            counted(len(self.record.bodies), "moving obstacle"),
        )  # fmt: skip
        where = f"{self.scenario.identity!r}, split={self.split!r}, seed={self.seed}"
        return f"World({where}: {', '.join(sizes)})"

    def _repr_html_(self) -> str:
        return self.svg()
