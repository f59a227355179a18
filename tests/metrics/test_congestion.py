"""Density against PedPy itself; jam, flow, rotation and fluctuation against closed forms."""

import math
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
import shapely

from benchnav.arena.solid import Kind, Solid
from benchnav.metrics import congestion, groups
from benchnav.metrics.quantities import density
from benchnav.metrics.quantities.density import walkable_area
from benchnav.metrics.quantities.episode_analysis import analyse
from benchnav.testing.episodes import Setting, Walk, box, record, room, straight
from benchnav.testing.zoo import AREA, ROOM, crowd, zoo

ALL = np.ones(64, np.bool_)


def _mine(episode):
    return episode.world.agents.evaluated


def _still(places, setting, radius=0.2, speed=(0.0, 0.0)):
    walks = [Walk(straight(p, speed), (90.0, 90.0), radius) for p in places]
    return record(walks, setting)


def test_density_is_pedpys_own():
    """PedPy, called directly on the same trajectories at every tenth state."""
    import pedpy

    episode = crowd().episode()
    steps, rows = len(episode.position), []
    over = episode.status != 0
    gone = np.where(over.any(axis=0), episode.arrival, math.inf)
    for frame, k in enumerate(range(0, steps, 10)):
        present = np.flatnonzero(0.1 * k <= gone)
        rows += [(agent, frame, *episode.position[k, agent]) for agent in present]
    data = pd.DataFrame(rows, columns=["id", "frame", "x", "y"])
    cells = pedpy.compute_individual_voronoi_polygons(
        traj_data=pedpy.TrajectoryData(data=data, frame_rate=1.0),
        walkable_area=pedpy.WalkableArea(shapely.box(*ROOM)),
        cut_off=pedpy.Cutoff(radius=0.8, quad_segments=16),
    )
    area = pedpy.MeasurementArea(shapely.box(*AREA))
    expected, _ = pedpy.compute_voronoi_density(
        individual_voronoi_data=cells, measurement_area=area
    )
    found = analyse(episode).density
    np.testing.assert_allclose(found, expected["density"], rtol=2e-3, atol=1e-6)
    assert congestion.density_mean(episode, ALL) == pytest.approx(
        expected["density"].mean(), rel=2e-3
    )
    assert congestion.density_peak(episode, ALL) == pytest.approx(
        expected["density"].max(), rel=2e-3
    )


@pytest.mark.parametrize("seed", range(4))
def test_leaving_out_who_is_far_away_changes_no_density(seed, monkeypatch):
    """With and without: random walks among walls, in and out of the measurement area."""
    rng = np.random.default_rng(seed)
    wall = Solid(Kind.WALL, (np.array([[0.6, -9.0], [0.6, 0.5]]),))
    solids = (room((-9, -9, 9, 9)), wall, box((-2.6, 0.0), 0.8, 2.0))
    setting = Setting(
        horizon=12.0, bounds=(-9, -9, 9, 9), area=(-1.5, -1.0, 1.5, 2.0), solids=solids
    )
    walks = [
        Walk(straight(rng.uniform(-7, 7, 2), rng.uniform(-1, 1, 2)), (90.0, 90.0), 0.2)
        for _ in range(12)
    ]
    episode = record(walks, setting)
    some = analyse(episode).density
    calls = []
    for name, everything in [
        ("_relevant", lambda area, frames, points: calls.append(1) or frames >= 0),
        ("_nearby", lambda walkable, area: calls.append(2) or walkable),
    ]:
        monkeypatch.setattr(density, name, everything)
    whole = analyse(replace(episode)).density
    assert calls == [1, 2]
    assert (some > 0).any()
    np.testing.assert_allclose(some, whole, rtol=1e-9, atol=1e-12)


def test_frames_in_which_nobody_is_near_are_not_computed(monkeypatch):
    """One walks past: cells are asked for while it is within 0.8 m of the area, and no longer."""
    asked = []
    real = density.diagram_cells

    def counted(frames, *arguments):
        asked.append(frames.tolist())
        return real(frames, *arguments)

    monkeypatch.setattr(density, "diagram_cells", counted)
    setting = Setting(horizon=20.0, area=(-1.0, -1.0, 1.0, 1.0))
    episode = record([Walk(straight((-10.0, 0.0), (1.0, 0.0)), (90.0, 0.0), 0.2)], setting)
    found = analyse(episode).density
    assert asked == [[9, 10, 11]]
    assert len(found) == 21
    assert np.flatnonzero(found).tolist() == [9, 10, 11]


def test_density_of_a_lattice_is_one_over_its_cell():
    places = [(x, y) for x in np.arange(-3.0, 3.1, 0.6) for y in np.arange(-3.0, 3.1, 0.6)]
    setting = Setting(horizon=2.0, bounds=(-4, -4, 4, 4), area=(-1.5, -1.5, 1.5, 1.5))
    assert congestion.density_mean(_still(places, setting), ALL) == pytest.approx(
        1 / 0.36, rel=1e-6
    )


def test_density_is_nothing_where_nobody_is_and_undefined_without_an_area():
    setting = Setting(horizon=2.0, area=(10.0, 10.0, 12.0, 12.0))
    assert congestion.density_peak(_still([(0.0, 0.0)], setting), ALL) == 0.0
    episode = _still([(0.0, 0.0)], Setting(horizon=2.0))
    for metric in (
        congestion.density_mean, congestion.density_peak, congestion.flow,
        congestion.velocity_fluctuation, congestion.congestion_level,
    ):  # fmt: skip
        assert math.isnan(metric(episode, ALL[:1]))


def test_cells_end_at_walls_thick_or_thin():
    """An agent 0.2 m from a wall, area on the other side: nothing of its cell is there."""
    thin = Solid(Kind.WALL, (np.array([[0.0, -9.0], [0.0, 9.0]]),))
    for wall in (thin, box((0.25, 0.0), 0.5, 18.0, Kind.WALL)):
        setting = Setting(
            horizon=1.0, bounds=(-9, -9, 9, 9), area=(0.0, -2.0, 2.0, 2.0),
            solids=(room((-9, -9, 9, 9)), wall),
        )  # fmt: skip
        episode = _still([(-0.2, 0.0)], setting, radius=0.15)
        assert congestion.density_peak(episode, ALL) == pytest.approx(0.0, abs=1e-12)


def test_walkable_area_is_what_solids_leave():
    def area(*solids):
        setting = Setting(bounds=(-3, -3, 3, 3), solids=solids, area=(-1, -1, 1, 1))
        return walkable_area(_still([(0.0, 0.0)], setting).world).area

    assert area() == 36.0
    assert area(room((-2, -2, 2, 2))) == pytest.approx(16.0, abs=0.02)
    assert area(box((2.0, 2.0), 1.0, 1.0)) == pytest.approx(35.0, abs=0.02)
    assert area(Solid(Kind.STATIC, center=(0.0, 2.0), radius=0.5)) == pytest.approx(
        36.0 - math.pi / 4, abs=0.02
    )
    ring = Solid(
        Kind.STATIC,
        (
            np.array([[-2.0, -2.0], [2.0, -2.0], [2.0, 2.0], [-2.0, 2.0]]),
            np.array([[-1.5, -1.5], [-1.5, 1.5], [1.5, 1.5], [1.5, -1.5]]),
        ),
    )
    assert area(ring) == pytest.approx(9.0, abs=0.02)  # the hollow, which holds the area


def test_jam_is_slow_and_near_and_not_there():
    def path(t):  # fast for 4 s, then a tenth of the preferred speed for 6 s
        return np.stack([np.minimum(t, 4.0) + 0.1 * np.maximum(t - 4.0, 0.0), 0.0 * t], axis=1)

    def beside(t):
        return path(t) + np.array([0.0, 0.8])

    setting = Setting(horizon=10.0)
    alone = record([Walk(path, (9.0, 0.0))], setting)
    assert congestion.jam(alone) == [0.0]
    both = record([Walk(path, (9.0, 0.0)), Walk(beside, (9.0, 0.8))], setting)
    assert congestion.jam(both) == pytest.approx([0.6, 0.6], abs=0.011)


def test_flow_counts_gaps_between_crossings():
    """Five in a row, 0.8 m apart at 1 m/s: one each 0.8 s."""
    walks = [Walk(straight((-2.0 - 0.8 * n, 0.0), (1.0, 0.0)), (9.0, 0.0), 0.2) for n in range(5)]
    setting = Setting(area=(-1.0, -1.0, 1.0, 1.0))
    episode = record(walks, setting)
    assert congestion.flow(episode, ALL[:5]) == pytest.approx(1.25)
    assert math.isnan(congestion.flow(episode, np.arange(5) == 2))
    beside = record(walks, Setting(area=(-1.0, 1.0, 1.0, 2.0)))
    assert math.isnan(congestion.flow(beside, ALL[:5]))


def test_first_crossings_are_pedpys():
    import pedpy

    episode = crowd().episode()
    rows = [
        (agent, frame, *episode.position[frame, agent])
        for agent in range(10)
        for frame in range(len(episode.position))
    ]
    data = pd.DataFrame(rows, columns=["id", "frame", "x", "y"])
    _, crossing = pedpy.compute_n_t(
        traj_data=pedpy.TrajectoryData(data=data, frame_rate=10.0),
        measurement_line=pedpy.MeasurementLine([(0.0, AREA[1]), (0.0, AREA[3])]),
    )
    found = congestion.first_crossings(analyse(episode), AREA)
    for agent, frame in zip(crossing["id"], crossing["frame"], strict=True):
        assert abs(found[agent] - frame / 10.0) <= 0.1 + 1e-9
    assert len(crossing) == np.isfinite(found).sum() == 10


def test_fluctuation_of_two_streams_is_half_their_difference():
    walks = [
        Walk(straight((-5.0, 1.0), (1.0, 0.0)), (90.0, 0.0)),
        Walk(straight((5.0, -1.0), (-1.0, 0.0)), (-90.0, 0.0)),
    ]
    setting = Setting(horizon=8.0, area=(-2.0, -2.0, 2.0, 2.0))
    assert congestion.velocity_fluctuation(record(walks, setting), ALL[:2]) == pytest.approx(1.0)
    alone = record(walks[:1], setting)
    assert math.isnan(congestion.velocity_fluctuation(alone, ALL[:1]))


def test_congestion_level_of_one_stream_is_zero_and_of_a_shear_its_step():
    """Lanes at 0.5 m that go the other way above the middle: one jump of 2 v over 0.5 m."""
    setting = Setting(horizon=9.9, bounds=(-20, -20, 20, 20), area=(-1.0, -1.0, 1.0, 1.0))
    lanes = [-0.75, -0.25, 0.25, 0.75]

    def walks(signs):
        return [
            Walk(straight((-s * (4.5 - 1.0 * n), y), (s, 0.0)), (s * 90.0, y), 0.1)
            for y, s in zip(lanes, signs, strict=True)
            for n in range(9)
        ]

    one = record(walks([0.5] * 4), setting)
    assert congestion.congestion_level(one, ALL[:36]) == pytest.approx(0.0, abs=1e-9)
    # rotation −∂vx/∂y: 1 m/s over 0.5 m at the middle, 0 elsewhere; mean speed 0.5 m/s
    two = record(walks([0.5, 0.5, -0.5, -0.5]), setting)
    assert congestion.congestion_level(two, ALL[:36]) == pytest.approx(2.0 / 0.5, rel=1e-6)


def test_groups_in_closed_form():
    """Seven discs that touch, in a hexagon around one."""
    angles = np.arange(6) * math.pi / 3
    ring = [(0.4 * math.cos(a), 0.4 * math.sin(a)) for a in angles]
    packed = _still([(0.0, 0.0), *ring], Setting(horizon=2.0), 0.2, (1.0, 0.0))
    expected = (6 * 0.4 / 7) / (2 / 3 * 0.2 * math.sqrt(7 * math.sqrt(12) / math.pi))
    assert groups.cohesion(packed, ALL[:7]) == pytest.approx(expected)
    assert groups.polarisation(packed, ALL[:7]) == pytest.approx(1.0)
    assert groups.splits(packed, ALL[:7]) == 1.0
    assert math.isnan(groups.cohesion(packed, np.arange(7) == 0))
    apart = _still([(0.0, 0.0), (1.1, 0.0), (2.2, 0.0), (9.0, 0.0)], Setting(horizon=2.0), 0.2)
    assert groups.splits(apart, ALL[:4]) == 2.0
    assert math.isnan(groups.polarisation(apart, ALL[:4]))
    cross = record(
        [
            Walk(straight((0.0, 0.0), (1.0, 0.0)), (90.0, 0.0)),
            Walk(straight((0.0, 5.0), (0.0, 1.0)), (0.0, 90.0)),
        ]
    )
    assert groups.polarisation(cross, ALL[:2]) == pytest.approx(math.sqrt(0.5))


def test_parts_are_those_of_scipy():
    from scipy.sparse.csgraph import connected_components

    rng = np.random.default_rng(0)
    place, radius = rng.uniform(-3, 3, (12, 5, 2)), rng.uniform(0.1, 0.3, 12)
    active = rng.random((12, 5)) < 0.8
    found = groups.part_counts(place, place, active, radius)
    for k in range(5):
        p, r = place[active[:, k], k], radius[active[:, k]]
        linked = np.hypot(*(p[:, None] - p[None]).transpose(2, 0, 1)) <= 3 * (r[:, None] + r)
        assert found[k] == connected_components(linked)[0]


def test_density_describes_everybody_in_the_area():
    episode = zoo()["crowd"]
    few = np.arange(10) == 0
    assert congestion.density_mean(episode, few) == congestion.density_mean(episode, _mine(episode))
