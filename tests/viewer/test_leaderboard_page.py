"""The HTML leaderboard in a real browser: it fits a phone, and rows keep their names."""

import pytest

from benchnav.leaderboard import leaderboard, render
from tests.leaderboard.tables import METRICS, scores, table
from tests.viewer.browser import DESKTOP, PHONE, in_browser, needs_chromium

pytestmark = [needs_chromium, pytest.mark.slow]
LONG = "mapping+visibility+recurrent-ppo-plus-with-a-long-name"


@pytest.fixture(scope="module")
def page():
    rows = []
    for metric in METRICS:
        rows += scores({LONG: [1.0, 0.0] * 10, "orca": [0.0, 1.0] * 10}, metric)
    return render(leaderboard(table(rows), METRICS), "html", metrics=["all"])


@pytest.mark.parametrize("size", [DESKTOP, PHONE])
def test_the_page_does_not_scroll_sideways_and_tables_keep_their_first_column(page, tmp_path, size):
    result = in_browser(page, """
      const frame = document.querySelector("div"), first = frame.querySelector("td");
      const scrolls = frame.scrollWidth > frame.clientWidth;
      frame.scrollLeft = 10000;
      const box = first.getBoundingClientRect(), edge = frame.getBoundingClientRect();
      const under = document.elementFromPoint(box.left + 5, box.top + 5);
      return {
        wide: document.documentElement.scrollWidth - innerWidth, scrolls, isOnTop: under === first,
        stays: Math.abs(box.left - edge.left) < 1, share: box.width / edge.width,
        moved: frame.scrollLeft, solid: getComputedStyle(first).backgroundColor,
      };
    """, tmp_path, size)  # fmt: skip
    assert result["wide"] <= 0
    assert result["stays"]
    assert result["isOnTop"]
    assert "rgba" not in result["solid"]  # nothing shines through it
    if size == PHONE:
        assert result["scrolls"]
        assert result["moved"] > 50
        assert result["share"] < 0.45
