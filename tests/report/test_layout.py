"""Pages of a report look as they did when somebody judged them, but for small details.

Pictures are compared after they are reduced until letters are grey: other fonts and numbers pass,
a lost style sheet, column or figure does not. After a change that was looked at, delete the kept
pictures: the tests make them again.
"""

import shutil
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
    "scenario": str(scenario_path("odd@1")), "failures": "failures.html",
}  # fmt: skip


def reduced(path, size):
    """Return grey values of a picture of ``size``, each the mean of a square."""
    image = Image.open(path).convert("L").crop((0, 0, *size))
    return image.resize((size[0] // SCALE, size[1] // SCALE), Image.Resampling.BOX)


def difference(one, other):
    return np.abs(np.asarray(one, np.float64) - np.asarray(other, np.float64)).mean()


@pytest.fixture(scope="module")
def anywhere(run, report, tmp_path_factory):
    """The report, as if its run lay in a folder of a short name: a long path wraps elsewhere."""
    copy = tmp_path_factory.mktemp("anywhere") / "report"
    shutil.copytree(report, copy)
    for page in copy.rglob("*.html"):
        page.write_text(page.read_text("utf-8").replace(str(run.path), "runs/small"), "utf-8")
    return copy


@pytest.mark.parametrize("screen", SIZES)
@pytest.mark.parametrize("page", PAGES)
def test_a_page_looks_as_it_did(anywhere, tmp_path, page, screen):
    kept, size = KEPT / f"{page}-{screen}.png", SIZES[screen]
    now = reduced(picture(anywhere / PAGES[page], tmp_path, size), size)
    if not kept.exists():
        kept.parent.mkdir(exist_ok=True)
        now.save(kept)
        pytest.fail(f"{kept} is new: look at the page, and run the test again")
    assert difference(now, Image.open(kept)) < ALIKE


@pytest.mark.parametrize("screen", SIZES)
def test_a_page_without_its_style_is_noticed(report, tmp_path, screen):
    bare = tmp_path / "report" / "index.html"
    bare.parent.mkdir()
    (bare.parent / "assets").symlink_to(report / "assets")
    bare.write_text((report / "index.html").read_text("utf-8").replace("report.css", "none.css"))
    now = reduced(picture(bare, tmp_path, SIZES[screen]), SIZES[screen])
    assert difference(now, Image.open(KEPT / f"leaderboard-{screen}.png")) > 2.0 * ALIKE
