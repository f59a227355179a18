"""Import every published file, run five navigators in each, verify, and print a table.

``python -m studies.published_files DATA [--out FOLDER] [--only TEXT]``. DATA is a folder with the
files that other projects published; they are not a part of this project. The runs and a replay of
each stay in the folder of ``--out``.
"""

import argparse
import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import benchnav

NAVIGATORS = ("straight-line", "orca", "none+social-force", "recurrent-ppo-plus", "ompl-orca")
SEEDS = 2
AGENTS = 4
Import = Callable[..., list[Path]]


@dataclass(frozen=True)
class Published:
    """A published file, and the import of it."""

    file: str
    importer: Import
    options: dict[str, Any]


def published(data: Path) -> Iterator[Published]:
    """Yield every importable file of DATA; the quickest first."""
    for number in (0, 6, 42):
        yield _world(f"barn/worlds/world_{number}.world", start=(-2, 3), goal=(-2, 13))
    yield _world("meshes/turtlebot3/turtlebot3_world/model.sdf")
    for path in sorted((data / "meshes").rglob("*.[dD][aA][eE]")):
        yield _world(str(path.relative_to(data)), margin=3, **_MESHES.get(path.name, {}))
    yield _recording("trajnetpp/collision_test.ndjson", rate=2.5)
    yield _recording("people/pedpy/trajectories.sqlite")
    walls = data / "people/pedpy/vadere_bottleneck.scenario"
    yield _recording("people/pedpy/vadere_postvis.traj", rate=24, walls=walls)
    yield _recording("people/pedpy/traj_UNI_CORR_500_01.txt", unit="m", walls="hull")
    yield _recording("people/pedpy/040_c_56_h-.txt")
    yield _recording("people/eth/obsmat.txt", rate=15)
    for name in ("testmap.png", "testmap.bmp", "testmap.pgm"):
        yield _world(f"ros_maps/{name}", resolution=0.5)
    for name in ("testmap", "tb3_sandbox", "turtlebot3/map", "depot"):
        yield _map(data, data / "ros_maps" / f"{name}.yaml")
    maps = (data / "movingai").glob("*.map")
    for path in sorted(maps, key=lambda path: (path.stat().st_size, path.name)):
        yield _map(data, path, scen=_queries(path))


_MESHES: dict[str, dict[str, Any]] = {  # these declare y as up, although it is z
    "hexagon.dae": {"up": "z"}, "wall.dae": {"up": "z"},
}  # fmt: skip


def _map(data: Path, path: Path, **options: Any) -> Published:
    agents = {} if options.get("scen") is None else {"agents": AGENTS}
    return Published(str(path.relative_to(data)), benchnav.import_map, {**agents, **options})


def _world(file: str, **options: Any) -> Published:
    agents = {} if "start" in options else {"agents": AGENTS}
    return Published(file, benchnav.import_world, {**agents, **options})


def _recording(file: str, **options: Any) -> Published:
    return Published(file, benchnav.import_recording, options)


def _queries(path: Path) -> Path | None:
    """Return the .scen file of a map; None: starts and goals are drawn."""
    found = (path.with_name(f"{path.stem}{ending}") for ending in (".map.scen", "-even-1.scen"))
    return next((file for file in found if file.exists()), None)


def measured(data: Path, each: Published, folder: Path) -> str:
    """Import a file, run the navigators in it, verify the run, and return the row of the table."""
    name = re.sub(r"[^a-z0-9_]+", "-", each.file.lower())
    scenario = folder / name / "scenario.yaml"
    each.importer(data / each.file, scenario, name=f"published/{name}", force=True, **each.options)
    run = benchnav.run(
        str(scenario), navigators=list(NAVIGATORS), seeds=SEEDS, out=folder / name / "run",
        workers=0, salt="00", quiet=True,
    )  # fmt: skip
    found = run.verify(twin=2, twin_seconds=5.0, workers=0, quiet=True)
    (folder / name / "verification.txt").write_text(found.text())
    run.episodes(seed=0).replay().save(folder / name / "replay.html")
    values = {
        record.navigator: record.value
        for record in run.leaderboard().records
        if record.metric == "success"
    }
    marks = [f"{values[navigator]:.2f}" for navigator in NAVIGATORS]
    verdict = "yes" if found.verified else f"{len(found.findings)} findings"
    return " | ".join([each.file, *marks, verdict])


def main() -> None:
    """Print one row for each file."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("data", type=Path)
    parser.add_argument("--out", type=Path, default=Path("runs/published"))
    parser.add_argument("--only", default="", help="files whose path holds this text")
    given = parser.parse_args()
    print("file |", " | ".join(NAVIGATORS), "| verified")
    for each in published(given.data):
        if given.only in each.file:
            print(measured(given.data, each, given.out), flush=True)


if __name__ == "__main__":
    main()
