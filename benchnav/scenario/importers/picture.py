"""Scenarios from pictures: dark pixels are obstacles."""

import tempfile
from pathlib import Path

import yaml

from benchnav.errors import UsageError
from benchnav.scenario.importers.bundle import write_scenario
from benchnav.scenario.importers.draft import Remark, default_name, import_ros_map, silent

DARK = 0.5  # default of the threshold


def import_image(
    path: Path,
    out: Path,
    *,
    resolution: float,
    threshold: float = DARK,
    negate: bool = False,
    origin: tuple[float, float] = (0.0, 0.0),
    agents: int | None = None,
    radius: float | None = None,
    name: str | None = None,
    force: bool = False,
    remark: Remark = silent,
) -> list[Path]:
    """Write a scenario on a picture, as a map of the ROS map_server, and return the files.

    Args:
        path: a PNG, PGM, BMP, JPEG, GIF or TIFF file.
        out: the scenario file.
        resolution: [m] of a pixel.
        threshold: darkness from 0 (white) to 1 (black) from which a pixel is an obstacle.
        negate: whether light pixels are obstacles.
        origin: (x, y) [m] of the lower left corner.
        agents: number of agents; None: 20, or as many as fit.
        radius: of an agent [m]; None: 0.2 m or less.
        name: of the scenario.
        force: whether to overwrite the scenario.
        remark: called with each remark.

    Raises MapError for a wrong picture, UsageError for a wrong value.
    """
    if not 0.0 < resolution < float("inf"):
        raise UsageError(f"resolution must be > 0 m. Got {resolution} instead.")
    if not 0.0 < threshold < 1.0:
        raise UsageError(f"threshold must be between 0 and 1. Got {threshold} instead.")
    header = {
        "image": str(path.resolve()), "resolution": resolution, "origin": [*origin, 0.0],
        "negate": int(negate), "occupied_thresh": threshold, "free_thresh": threshold - 1e-6,
    }  # fmt: skip
    with tempfile.TemporaryDirectory() as folder:
        map_file = Path(folder) / f"{path.stem}-map.yaml"
        map_file.write_text(yaml.safe_dump(header, allow_unicode=True), encoding="utf-8")
        called = name or default_name("image", path, out)
        scenario = import_ros_map(
            map_file, agents=agents, radius=radius, name=called, remark=remark
        )
        scenario["title"] = scenario["title"].replace(map_file.name, path.name)
        return write_scenario(scenario, out, force)
