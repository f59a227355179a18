"""Draws the gallery of the documentation: ``python docs/make_gallery.py``.

Writes `gallery.md`, a picture of three worlds of each shipped scenario in `images/gallery`, and the
replays that the page embeds in `_static/replays`.
"""

from itertools import groupby
from pathlib import Path

import numpy as np
from PIL import Image

import benchnav
from benchnav.api.records.replay import Replay
from benchnav.drawing.top_view import TopView
from benchnav.generation.build import build
from benchnav.scenario.catalogue import find, names
from benchnav.world.simulation import Simulation

DOCS = Path(__file__).parent
PICTURES = DOCS / "images" / "gallery"
REPLAYS = DOCS / "_static" / "replays"
SEEDS = (0, 1, 2)
HEIGHT, WIDTH, GAP = 240, 720, 12  # [pixels] of one world at most, and between two
COLORS = 64  # in a file, which keeps it small
EPISODES = (  # of (file, scenario, seed, track, navigators, what to see)
    (
        "dynamic", "leaders/dynamic", 3, "known", ("orca", "recurrent-ppo-vo"),
        "Moving obstacles, seen by seven rays: the local planner ORCA, and the learned policy.",
    ),
    (
        "trap", "trap/u", 1, "unknown", ("orca", "mapping+visibility+orca"),
        "A trap in an unknown map: ORCA alone moves into it and gets stuck. A planner that makes"
        " its own map on the way gets out: click an agent to see this map.",
    ),
    (
        "groups", "groups/crossing-four", 0, "known", ("orca", "guided-crowd"),
        "Four groups cross: ORCA controls every agent alone, or the groups follow leaders whose"
        " paths were recorded before.",
    ),
)  # fmt: skip
HEAD = """\
# Gallery

The scenarios that ship with benchnav, and some episodes to play.

## Episodes
"""


def picture(scenario: str) -> None:
    """Write three worlds of a scenario, side by side or, if they are wide, one below the other."""
    frames = [frame(scenario, seed) for seed in SEEDS]
    sizes = np.array([image.size for image in frames])
    axis = 0 if frames[0].width < WIDTH else 1
    whole = sizes.max(axis=0)
    whole[axis] = sizes.sum(axis=0)[axis] + GAP * (len(SEEDS) - 1)
    sheet, place = Image.new("RGB", tuple(whole.tolist()), "white"), np.zeros(2, int)
    for image, size in zip(frames, sizes, strict=True):
        sheet.paste(image, tuple(place.tolist()))
        place[axis] += size[axis] + GAP
    sheet.quantize(COLORS).save(PICTURES / f"{file_of(scenario)}.png", optimize=True)


def frame(scenario: str, seed: int) -> Image.Image:
    """Return a picture of the start of a test world."""
    world = build(find(scenario), "test", seed)
    start = Simulation([world])
    view = TopView(world, 2 * WIDTH)
    drawn = view.draw(
        world.agents.start, start.heading[0], start.body_position[0], start.present[0]
    )
    image = Image.fromarray(drawn.array())
    image.thumbnail((WIDTH, HEIGHT), Image.Resampling.LANCZOS)
    return image


def replay(file: str, scenario: str, seed: int, track: str, navigators: tuple[str, ...]) -> None:
    """Write the page that plays navigators side by side in one world."""
    world = benchnav.load_scenario(scenario).world(seed=seed)
    episodes = [benchnav.simulate(world, navigator, track=track) for navigator in navigators]
    page = Replay.of(episodes).page(assets="..")  # conf.py copies the assets to _static
    (REPLAYS / f"{file}.html").write_text(page, encoding="utf-8")


def page() -> str:
    """Return the text of the page."""
    parts = [HEAD]
    for file, scenario, _, track, navigators, text in EPISODES:
        who = " and ".join(f"`{navigator}`" for navigator in navigators)
        parts += [
            f"{text} {who} in `{scenario}`, track `{track}`"
            f' (<a href="_static/replays/{file}.html">whole page</a>):\n',
            f'<iframe class="replay" loading="lazy" title="Replay of {scenario}"'
            f' src="_static/replays/{file}.html"></iframe>\n',
        ]
    parts.append("## Scenarios\n\nThree test worlds of each, at the start.\n")
    for family, members in groupby(names(), lambda name: name.partition("/")[0]):
        parts.append(f"### {family}\n")
        for name in members:
            parts += [
                f"**`{name}`**: {find(name).title}\n",
                f"![Three worlds of {name}](images/gallery/{file_of(name)}.png)\n",
            ]
    return "\n".join(parts)


def file_of(scenario: str) -> str:
    """Return the name of a scenario as a name of a file."""
    return scenario.replace("/", "-")


def main() -> None:
    """Write the page with its pictures and replays."""
    for folder in (PICTURES, REPLAYS):
        folder.mkdir(parents=True, exist_ok=True)
    for name in names():
        picture(name)
    for file, scenario, seed, track, navigators, _ in EPISODES:
        replay(file, scenario, seed, track, navigators)
    (DOCS / "gallery.md").write_text(page(), encoding="utf-8")


if __name__ == "__main__":
    main()
