"""`benchnav show` and `benchnav validate` of a scenario: one page, and which worlds coincide."""

import pytest

from benchnav.api.components.scenario_page import WIDTH
from tests.cli.conftest import TINY
from tests.scenario.files import SHIPPED

DIFFER = "differ from seed to seed, and between train, validation and test"
SAME = "are all the same: nothing in them is random, so train, validation and test coincide"


def flat(text):
    return " ".join(text.split())


@pytest.mark.parametrize("path", SHIPPED, ids=lambda p: f"{p.parent.name}/{p.stem}")
def test_every_shipped_scenario_fits_a_page(call, path):
    code, stdout, _ = call("show", f"{path.parent.name}/{path.stem}")
    assert code == 0
    lines = stdout.splitlines()
    assert len(lines) <= 40
    assert max(map(len, lines)) <= WIDTH
    for key in ("is", "arena", "team", "sensing", "clock", "rules", "tracks", "worlds", "hash"):
        assert sum(line.startswith(f"  {key} ") for line in lines) == 1
    assert DIFFER in flat(stdout)


def test_a_page_says_what_there_is(call):
    said = flat(call("show", "leaders/moving-furniture")[1])
    for part in (
        "20 m × 20 m, walled", "4 to 6 × box of 1 to 2 m × 1 to 2 m, drawn anywhere",
        "each re-placed once, after 3 to 12 s", "4 unicycle leaders, radius 0.5 m, 2 m/s",
        "at least 4 m away", "a decision every 0.2 s", "until 50 s", "contact: end",
        "known, stale, partial, unknown",
    ):  # fmt: skip
        assert part in said
    said = flat(call("show", "crowd/circle-crossing")[1])
    assert "1 holonomic leader, radius 0.3 m, 1 m/s; start at points, goal at points" in said
    assert "background, driven by orca; does not see robot" in said


def test_worlds_that_coincide_are_reported(call, tmp_path):
    path = tmp_path / "open.yaml"
    path.write_text(TINY)
    for verb in ("show", "validate"):
        code, stdout, _ = call(verb, path)
        assert code == 0
        assert SAME in flat(stdout)
    path.write_text(TINY.replace("radius: 0.2", "radius: {choice: [0.2, 0.3]}"))
    part = flat(call("validate", path)[1])
    assert "its worlds coincide in part (split and seed): train 0 = " in part
    path.write_text(TINY.replace("radius: 0.2", "radius: {uniform: [0.2, 0.3]}"))
    assert f"its worlds {DIFFER}" in flat(call("validate", path)[1])


def test_what_cannot_be_drawn_is_shown_all_the_same(call, tmp_path):
    path = tmp_path / "full.yaml"
    path.write_text(TINY.replace("radius: 0.2", "radius: 1.4").replace("count: 2", "count: 9"))
    code, stdout, _ = call("show", path)
    assert code == 0
    assert "worlds none: tiny/open@1" in flat(stdout)
