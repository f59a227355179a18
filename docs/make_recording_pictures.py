"""Draw the picture of recordings.md: ``python docs/make_recording_pictures.py DATA``.

DATA is a folder with the published recordings, which are not a part of this project.
"""

import sys
import tempfile
from pathlib import Path

import benchnav
from benchnav.viewer.scene_figure import episode_figure

PEDPY = "people/pedpy"
RECORDINGS = {
    "ETH seq_eth": ("people/eth/obsmat.txt", {"rate": 15, "replace": 60}),
    "bottleneck": (f"{PEDPY}/040_c_56_h-.txt", {}),
    "corridor": (f"{PEDPY}/traj_UNI_CORR_500_01.txt", {"unit": "m", "walls": "hull"}),
    "JuPedSim": (f"{PEDPY}/trajectories.sqlite", {}),
    "Vadere": (f"{PEDPY}/vadere_postvis.traj", {"rate": 24}),
}
WALLS = {"Vadere": f"{PEDPY}/vadere_bottleneck.scenario"}


def main(data: Path) -> None:
    """Import each recording, run ORCA in it, and draw the episode."""
    episodes = []
    with tempfile.TemporaryDirectory() as folder:
        for name, (file, options) in RECORDINGS.items():
            if name in WALLS:
                options = {**options, "walls": data / WALLS[name]}
            out = Path(folder) / f"{len(episodes)}.yaml"
            files = benchnav.import_recording(data / file, out, **options)
            world = benchnav.load_scenario(files[0]).world(seed=1)
            episodes.append(benchnav.simulate(world, "orca", salt="00").record)
        figure = episode_figure(episodes, ())
        for axes, name in zip(figure.axes, RECORDINGS, strict=False):
            axes.set_title(name, fontsize=9)
    figure.savefig(Path(__file__).parent / "images" / "recordings.png", dpi=110)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
