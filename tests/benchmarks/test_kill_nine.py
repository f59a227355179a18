"""A run that is killed again and again ends as one that nobody disturbed."""

import pytest

from benchnav.processes.process_tree import memory_is_known
from studies.kill_nine import courses, survive

SCENARIO = """
name: tiny/open
title: Two discs that change places
bounds: [-3, -3, 3, 3]
teams:
  - name: pair
    count: 2
    radius: 0.2
    max_speed: 1
    start: {type: circle, radius: 2}
    goal: {type: antipodal}
clock: {dt: 0.2, substeps: 2, horizon: 6}
"""


@pytest.mark.long
@pytest.mark.skipif(not memory_is_known(), reason="without /proc nobody knows who is still there")
@pytest.mark.parametrize(("k", "parent_only"), [(0, True), (2, False)])
def test_what_is_killed_ends_as_an_unbroken_one(tmp_path, k, parent_only):
    (tmp_path / "open.yaml").write_text(SCENARIO)
    suite = tmp_path / "suite.yaml"
    suite.write_text("name: tiny\nscenarios: [open.yaml]\nnavigators: [orca, random-walk]\n")
    course = courses(str(suite), ("--seeds", "40", "--workers", "2"))[k]
    tally = survive(course, tmp_path, 2, parent_only=parent_only, seed=1)
    assert tally.kills == 2
    assert tally.finished >= 1
