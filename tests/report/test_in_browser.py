"""A report in a real browser: its pages load, sort, filter and play, and ask for no other host."""

from pathlib import Path

import pytest

from benchnav.report.page import FAILURES, LEADERBOARD, replay_path, scenario_path
from studies.reference_run import unpack_report
from tests.report.conftest import EVIL
from tests.viewer.browser import DESKTOP, PHONE, from_disk, in_site, needs_chromium

pytestmark = [needs_chromium, pytest.mark.slow]
READY = 'await until(() => document.documentElement.dataset.tables === "ready");'
ROWS = """
  const rows = () => [...document.querySelectorAll("table.data tbody tr")];
  const column = (k) => rows().map((row) => row.cells[k].textContent.trim());
  const choose = (name, value) => {
    const select = document.querySelector(`.filters select[name=${name}]`);
    select.value = value; select.dispatchEvent(new Event("change", { bubbles: true }));
  };
  const heads = () => [...document.querySelectorAll("table.data th")].map((h) => h.dataset.name);
"""


def pages(report):
    """A page of each kind."""
    top = sorted(str(path.relative_to(report)) for path in report.glob("*.html"))
    below = (sorted((report / name).glob("*.html"))[0] for name in ("scenarios", "navigators"))
    return [*top, *(str(path.relative_to(report)) for path in below)]


def test_every_page_loads_and_nothing_sticks_out(report, tmp_path):
    wide = [(page, DESKTOP) for page in (str(LEADERBOARD), str(scenario_path("odd@1")))]
    for page, size in [*((page, PHONE) for page in pages(report)), *wide]:
        wider = in_site(report, page, """
          for (const area of document.querySelectorAll(".plot-area")) {
            area.scrollIntoView();
            await until(() => area.querySelector("svg"));
          }
          const ready = () => document.documentElement.dataset.tables === "ready";
          if (document.querySelector("table.data")) await until(ready);
          return document.documentElement.scrollWidth - innerWidth;
        """, tmp_path, size)  # fmt: skip
        assert wider <= 0, (page, size)


def test_the_leaderboard_is_sorted_and_filtered(report, tmp_path):
    result = in_site(report, str(LEADERBOARD), READY + ROWS + """
      const out = { first: rows().length, heads: heads() };
      const head = document.querySelector("th[data-name=success]");
      head.click(); await wait(0.1);
      const place = heads().indexOf("success");
      out.rising = column(place).map(parseFloat);
      head.click(); await wait(0.1);
      out.falling = column(place).map(parseFloat);
      choose("scenario", "trap/u@1"); choose("track", "unknown");
      out.unknown = column(0).length;
      choose("track", "");
      out.any = rows().length;
      out.tracks = new Set(column(heads().indexOf("track"))).size;
      choose("family", "odd");
      out.reset = document.querySelector(".filters select[name=scenario]").value;
      out.address = location.hash;
      document.querySelector(".columns input[data-column=timeout]").click();
      out.metrics = heads();
      return out;
    """, tmp_path)  # fmt: skip
    assert result["first"] == 3
    assert "scenario" not in result["heads"]
    assert result["rising"] == sorted(result["rising"])
    assert result["falling"] == sorted(result["falling"], reverse=True)
    assert result["unknown"] == 3  # one of them n/a
    assert (result["any"], result["tracks"]) == (6, 2)
    assert result["reset"] == ""
    assert "family=odd" in result["address"]
    assert "timeout" in result["metrics"]


def test_an_address_chooses_the_rows(report, tmp_path):
    address = f"{LEADERBOARD}#scenario=odd@1&track=known"
    names = in_site(report, address, READY + ROWS + "return column(0);", tmp_path)
    assert sorted(names) == sorted([EVIL, "straight-line", "visibility+orca"])


def test_hostile_names_stay_text_in_tables_and_figures(report, tmp_path):
    for page in (LEADERBOARD, FAILURES, scenario_path("odd@1")):
        images = in_site(report, str(page), """
          for (const area of document.querySelectorAll(".plot-area")) area.scrollIntoView();
          await wait(0.5);
          const box = document.querySelector(".dt-search input");
          if (box) { box.value = "<img"; box.dispatchEvent(new Event("input")); await wait(0.5); }
          return document.querySelectorAll("img").length;
        """, tmp_path)  # fmt: skip
        assert images == 0, page


def test_a_replay_that_the_report_links_plays(report, tmp_path):
    page = str(replay_path("straight-line", "trap/u@1", "known", 0))
    in_site(report, page, """
      await until(() => document.documentElement.dataset.ready === "true");
      document.querySelector("button.play").click();
      await until(() => replay.time > 0.3);
    """, tmp_path)  # fmt: skip


def test_it_opens_from_disk(report, tmp_path):
    assert 'data-tables="ready"' in from_disk(report / LEADERBOARD, tmp_path)
    page = replay_path("straight-line", "trap/u@1", "known", 0)
    assert 'data-ready="true"' in from_disk(report / page, tmp_path)


def test_the_report_of_the_reference_run_loads(tmp_path):
    kept = Path(__file__).parents[2] / "docs/leaderboard"
    archive = max(kept.glob("standard-*-report.tar.xz"))
    report = unpack_report(archive, tmp_path / "site")
    replay = sorted((report / "replays").glob("*.html"))[0]
    for page in [*pages(report), str(replay.relative_to(report))]:
        in_site(report, page, "return document.title;", tmp_path, DESKTOP)
