"""The generated city, on which plans are measured where no published map is present."""

import numpy as np
from benchnav_baselines.common.validity_checker import PlanarChecker

from benchmarks import planning
from benchnav.geometry import FreeSpace


def test_generated_streets_join_most_places_and_are_the_same_again(monkeypatch, tmp_path):
    monkeypatch.setattr(planning, "CITY", tmp_path / "none.map")
    (map, queries), (again, _) = planning.city.__wrapped__(), planning.city.__wrapped__()
    np.testing.assert_array_equal(map.capsules, again.capsules)
    checker, space = PlanarChecker(map, planning.RADIUS), FreeSpace(map.capsules, planning.RADIUS)
    assert len(queries) == 950
    assert all(checker.point_is_free(*end) for ends in queries for end in ends)
    lengths = [space.length(*ends, planning.TOLERANCE) for ends in queries[:100]]
    assert np.isfinite(lengths).mean() > 0.9
