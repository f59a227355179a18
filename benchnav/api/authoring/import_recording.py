"""Convert recordings of people into scenario files."""

from collections.abc import Sequence
from os import PathLike
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Literal

from benchnav.api.output.messages import message, silent
from benchnav.errors import UsageError
from benchnav.navigation.plugin.configure import configure
from benchnav.plugins import CONTROLLERS, NAVIGATORS
from benchnav.processes.main_module import stop_import_of_main
from benchnav.scenario.importers import default_name, demand_name, write_scenario
from benchnav.scenario.importers.recording import Request, find_format
from benchnav.scenario.importers.recording import import_recording as draft


def import_recording(
    recording: "str | PathLike[str]",
    out: "str | PathLike[str]",
    *,
    format: str | None = None,
    rate: float | None = None,
    unit: str | None = None,
    columns: Sequence[str] | None = None,
    gaps: Literal["refuse", "split", "bridge"] = "refuse",
    replace: str | int = "random",
    react: str | None = None,
    walls: "str | PathLike[str] | None" = None,
    wall_cell: float | None = None,
    wall_origin: tuple[float, float] | None = None,
    wall_negate: bool = False,
    person_radius: float = 0.2,
    radius: float | None = None,
    speed: float = 1.5,
    horizon: float | None = None,
    name: str | None = None,
    force: bool = False,
    quiet: bool = False,
) -> list[Path]:
    """Convert a recording of people into a scenario, and return the files written.

    The scenario is the first file; the second holds the people in metres.

    Args:
        recording: a file of any of the formats.
        out: the scenario file.
        format: "eth", "text", "trajnetpp", "juelich", "hdf5", "jupedsim", "vadere", "viswalk",
            "crowdit", "pathfinder-csv", "pathfinder-json", or "pedpy" for that of PedPy's formats
            which the file has; None: by suffix and content.
        rate: frames per second; None: the file's own.
        unit: "m", "cm", "mm", "ft", "in" or metres per unit; None: the file's own, or metres.
        columns: of a text file, of "frame", "id", "x", "y" and "_"; None: by its header.
        gaps: whether gaps in tracks are refused, split or bridged.
        replace: id of the person that the robot replaces; "random": one that the seed draws;
            "none": no person.
        react: navigator or controller that moves the other people; None: they follow the recording.
        walls: "none", "hull", or a file: WKT, ROS map, image, Vadere scenario, Crowd:it geometry;
            None: the recording's own walkable area, or none.
        wall_cell: metres per pixel of an image of walls.
        wall_origin: of its lower left corner [m].
        wall_negate: whether its light pixels are walls.
        person_radius: of a person [m].
        radius: of the robot [m]; None: that of a person.
        speed: of the robot, at most [m/s].
        horizon: time limit [s]; None: twice the longest track, 20 to 300 s.
        name: of the scenario; None: from ``out`` or the recording.
        force: overwrite the scenario file.
        quiet: print no remarks.

    Raises ScenarioError or MapError for a wrong file, and UsageError for a mistake in the call.
    """
    stop_import_of_main()
    demand_name(name)
    path, target = Path(recording), Path(out)
    request = Request(
        format=find_format(path, format), rate=rate, unit=unit,
        columns=None if columns is None else tuple(columns), gaps=gaps,
        replace=str(replace), driver=_driver(react),
        walls=None if walls is None else str(walls), wall_cell=wall_cell, wall_origin=wall_origin,
        wall_negate=wall_negate, person_radius=person_radius, radius=radius, speed=speed,
        horizon=horizon,
    )  # fmt: skip
    if columns is not None and sorted(c for c in columns if c != "_") != ["frame", "id", "x", "y"]:
        raise UsageError(
            "columns must name frame, id, x and y once, such as frame,id,x,_,y; got"
            f" {','.join(columns)}."
        )
    called = name or default_name("people", path, target)
    with TemporaryDirectory(prefix="benchnav-") as scratch:
        mapping, people = draft(path, called, request, Path(scratch), silent if quiet else message)
        return write_scenario(mapping, target, force, people)


def _driver(name: str | None) -> str | None:
    """Return the navigator that ``name`` stands for; a controller alone heads for the goal.

    Raises PluginError if there is none.
    """
    if name is None:
        return None
    alone = name in CONTROLLERS.names() and name not in NAVIGATORS.names()
    driver = f"none+{name}" if alone else name
    configure(NAVIGATORS, driver)
    return driver
