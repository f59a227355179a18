"""The comparison in a real browser: two menus, figures, a table, and an address to share."""

import pytest

from benchnav.report.page import COMPARISON
from tests.report.conftest import EVIL
from tests.viewer.browser import PHONE, in_site, needs_chromium

pytestmark = [needs_chromium, pytest.mark.slow]
SETUP = """
  await until(() => document.querySelector("#forests svg"));
  const choose = (id, text) => {
    const menu = document.getElementById(id);
    menu.value = [...menu.options].find((option) => option.text === text).value;
    menu.dispatchEvent(new Event("change"));
  };
  const table = () => [...document.querySelectorAll("#differences tbody tr")].map((row) =>
    [...row.cells].map((cell) => cell.firstChild?.textContent ?? ""));
"""


def test_two_menus_choose_a_pair(report, run, tmp_path):
    found = in_site(report, str(COMPARISON), SETUP + """
      choose("second", "visibility+orca");
      choose("first", "straight-line");
      const one = table();
      document.getElementById("swap").click();
      return {
        one, other: table(), figures: document.querySelectorAll("#forests svg.main-svg").length,
        menus: ["first", "second"].map((id) => document.getElementById(id).selectedOptions[0].text),
        address: new URLSearchParams(location.hash.slice(1)).get("a"),
        command: document.getElementById("command").textContent,
        wide: document.documentElement.scrollWidth - innerWidth,
      };
    """, tmp_path, PHONE)  # fmt: skip
    assert found["menus"] == ["visibility+orca", "straight-line"]
    assert found["command"] == f"benchnav compare {run.path} visibility+orca straight-line"
    assert found["address"] == "visibility+orca"
    assert found["figures"] >= 4
    assert found["wide"] <= 0
    compared = run.compare("straight-line", "visibility+orca").records
    difference = {c.scenario: c.difference for c in compared if c.metric == "success"}
    for row, mirrored in zip(found["one"], found["other"], strict=True):
        wanted = difference["all" if row[0] == "all scenarios" else row[0]]
        value, turned = (float(each[2].split()[0].replace("−", "-")) for each in (row, mirrored))
        assert value == pytest.approx(wanted, abs=0.01)
        assert turned == -value


def test_notes_are_those_of_the_chosen_track(report, tmp_path):
    notes = in_site(report, str(COMPARISON), SETUP + """
      choose("second", "visibility+orca");
      choose("first", "straight-line");
      const found = {};
      for (const track of ["known", "unknown"]) {
        choose("track", track);
        found[track] = document.getElementById("notes").textContent;
      }
      return found;
    """, tmp_path)  # fmt: skip
    assert notes["known"] == ""
    assert "visibility+orca needs a map" in notes["unknown"]


def test_a_label_that_tries_to_be_markup_is_text(report, run, tmp_path):
    found = in_site(report, str(COMPARISON), SETUP + f"""
      choose("second", "straight-line");
      choose("first", {EVIL!r});
      const images = document.querySelectorAll("img").length;
      return [images, document.getElementById("command").textContent];
    """, tmp_path)  # fmt: skip
    assert found == [0, f"benchnav compare {run.path} '{EVIL}' straight-line"]
