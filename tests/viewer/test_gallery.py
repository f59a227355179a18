"""The replays of the documentation's gallery play with the script of this version."""

import shutil
from pathlib import Path

import pytest

from tests.viewer.browser import in_site, needs_chromium

ROOT = Path(__file__).parents[2]
REPLAYS = sorted((ROOT / "docs/_static/replays").glob("*.html"))


@needs_chromium
@pytest.mark.parametrize("replay", REPLAYS, ids=lambda path: path.stem)
def test_a_replay_of_the_gallery_plays(replay, tmp_path):
    site = tmp_path / "_static"
    (site / "replays").mkdir(parents=True)
    shutil.copy(replay, site / "replays")
    for name in ("replay.js", "replay.css"):
        shutil.copy(ROOT / "benchnav/viewer/replay" / name, site)
    time = in_site(site, f"replays/{replay.name}", """
      await until(() => document.documentElement.dataset.ready === "true");
      [...document.querySelectorAll("button")].find((b) => b.textContent === "Play").click();
      await until(() => replay.time > 0.3);
      return replay.time;
    """, tmp_path)  # fmt: skip
    assert time > 0.3
