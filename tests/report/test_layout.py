"""Pages of a report look as they did when somebody judged them, but for small details.

Pictures are compared after they are reduced until letters are grey: other fonts and numbers pass,
a lost style sheet, column or figure does not. After a change that was looked at, delete the kept
pictures: the tests make them again.
"""

from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from benchnav.report.page import scenario_path
from tests.viewer.browser import DESKTOP, PHONE, needs_chromium, picture

pytestmark = [needs_chromium, pytest.mark.slow]
KEPT = Path(__file__).with_name("layouts")
SCALE = 20  # pixels that become one
ALIKE = 5.0  # mean difference of grey values (0 to 255) that fonts and numbers may make
SIZES = {"desktop": DESKTOP, "phone": PHONE}
PAGES = {
    "leaderboard": "index.html", "comparison": "comparison.html",
    "scenario": str(scenario_path("odd@1")),
}  # fmt: skip


def reduced(path, size):
    """Return grey values of a picture of ``size``, each the mean of a square."""
    image = Image.open(path).convert("L").crop((0, 0, *size))
    return image.resize((size[0] // SCALE, size[1] // SCALE), Image.Resampling.BOX)


def difference(one, other):
    return np.abs(np.asarray(one, np.float64) - np.asarray(other, np.float64)).mean()


@pytest.mark.parametrize("screen", SIZES)
@pytest.mark.parametrize("page", PAGES)
def test_a_page_looks_as_it_did(report, tmp_path, page, screen):
    kept, size = KEPT / f"{page}-{screen}.png", SIZES[screen]
    now = reduced(picture(report / PAGES[page], tmp_path, size), size)
    if not kept.exists():
        kept.parent.mkdir(exist_ok=True)
        now.save(kept)
        pytest.fail(f"{kept} is new: look at the page, and run the test again")
    apart = difference(now, Image.open(kept))
    for _ in range(3):  # on a busy machine, a picture may be taken before the tables are there
        if apart >= ALIKE:
            again = reduced(picture(report / PAGES[page], tmp_path, size), size)
            apart = difference(again, Image.open(kept))
    assert apart < ALIKE


@pytest.mark.parametrize("screen", SIZES)
def test_a_page_without_its_style_is_noticed(report, tmp_path, screen):
    bare = tmp_path / "report" / "index.html"
    bare.parent.mkdir()
    (bare.parent / "assets").symlink_to(report / "assets")
    bare.write_text((report / "index.html").read_text("utf-8").replace("report.css", "none.css"))
    now = reduced(picture(bare, tmp_path, SIZES[screen]), SIZES[screen])
    assert difference(now, Image.open(KEPT / f"leaderboard-{screen}.png")) > 2.0 * ALIKE
