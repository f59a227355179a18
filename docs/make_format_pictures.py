"""Draw the pictures of the pages in docs/formats: ``python docs/make_format_pictures.py [NAME…]``.

Each page makes a small file and imports it. The picture is an episode in the imported scenario.
"""

import os
import re
import shlex
import sys
import tempfile
from pathlib import Path

import matplotlib
from PIL import Image

import benchnav
from benchnav.cli.main import status
from benchnav.scenario.load import load_scenario
from benchnav.viewer.scene_figure import episode_figure

DOCS = Path(__file__).resolve().parent
BLOCK = re.compile(r"^```(python|shell)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
COLOURS = 64  # in the file, which keeps it small
SEED = 2


def imported(page: Path) -> str:
    """Do what a page says, in the working directory; return the scenario that it writes."""
    words: list[str] = []
    for language, text in BLOCK.findall(page.read_text("utf-8")):
        if language == "python":
            exec(compile(text, str(page), "exec"), {})  # noqa: S102 - a page of this project
        else:
            words = shlex.split(text)
            if status(words[1:]):
                raise SystemExit(f"{page}: {text}")
    return words[words.index("--out") + 1]


def draw(page: Path) -> None:
    """Write `images/formats/NAME.png`."""
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        file = imported(page)
        navigator = "orca" if load_scenario(Path(file)).recording else "ompl-orca"
        world = benchnav.load_scenario(file).world(seed=SEED)
        figure = episode_figure([benchnav.simulate(world, navigator, salt="00").record], ())
        os.chdir(DOCS)
    for axes in figure.axes:
        axes.set_title("")
    path = DOCS / "images" / "formats" / f"{page.stem}.png"
    path.parent.mkdir(exist_ok=True)
    figure.savefig(path, dpi=90)
    Image.open(path).convert("RGB").quantize(COLOURS).save(path, optimize=True)


def main(names: list[str]) -> None:
    """Draw the pictures of some pages; without names, of all."""
    matplotlib.use("Agg")
    for page in sorted((DOCS / "formats").glob("*.md")):
        if page.stem != "README" and (not names or page.stem in names):
            draw(page)


if __name__ == "__main__":
    main(sys.argv[1:])
