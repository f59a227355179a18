"""The kernels of metrics against plain numpy: the same bits."""

import math

import numpy as np
import pandas as pd
import pytest
import shapely

from benchnav.metrics import congestion, groups, safety, smoothness
from benchnav.metrics.measure import (
    Cell,
    all_metrics,
    measure_alone,
    measure_roles,
    subjects,
)
from benchnav.metrics.quantities import density, lowpass, trajectory
from benchnav.metrics.quantities.episode_analysis import analyse
from benchnav.metrics.quantities.numpy_sum import numpy_sum
from benchnav.testing.episodes import Setting, Walk, record, straight, wave
from benchnav.testing.zoo import zoo
from tests.reference import metrics as slow

same = np.testing.assert_array_equal  # NaN equals NaN


@pytest.fixture(scope="module", params=[*zoo(), "wavy"])
def episode(request):
    """An episode of the zoo, or a long one of many agents, of which some come near each other."""
    if request.param != "wavy":
        return zoo()[request.param]
    rng = np.random.default_rng(3)
    walks = [
        Walk(wave((x, y), 0.4 + 0.1 * k, 0.4, 2.0 + k), (x + 9.0, y), team=k % 2)
        for k, (x, y) in enumerate(rng.uniform(-4.0, 4.0, (11, 2)))
    ]
    return record(walks, Setting(horizon=40.0))


def test_sums_are_numpys():
    rng = np.random.default_rng(0)
    for size in [*range(300), 1000, 1023, 4097, 100_003]:
        values = rng.normal(size=size) * 10.0 ** rng.integers(-8, 8, size)
        assert numpy_sum(values) == values.sum()
        same(np.stack([values, values]).sum(axis=1), numpy_sum(values))


def test_trajectories(episode):
    t = trajectory.cut(episode)
    arrays = (t.last, t.end, t.position, t.duration, t.velocity, t.length)
    for found, expected in zip(arrays, slow.cut(episode), strict=True):
        same(found, expected)
    times = np.append(np.arange(0.0, t.duration.shape[1] * t.dt, 0.37), t.end)
    same(trajectory.positions_at(t, times), slow.positions_at(t, times))


def test_places_of_a_record_without_steps():
    walk = Walk(straight((1.0, 2.0), (0.0, 0.0)), (1.0, 2.0))
    whole = trajectory.cut(record([walk]))
    none = trajectory.Trajectories(
        0.1, np.zeros(1, np.int64), np.zeros(1), whole.position[:, :1].copy(), np.zeros((1, 0)),
        np.zeros((1, 0, 2)), np.ones(1, np.int64), np.zeros(1), np.zeros(1, np.bool_),
    )  # fmt: skip
    same(trajectory.positions_at(none, np.array([0.0, 3.0])), [[[1.0, 2.0], [1.0, 2.0]]])


def test_shares_of_time_and_turns(episode):
    same(congestion.jam(episode), slow.jam(episode))
    for distance in (0.45, 1.2):
        same(safety._share_within(episode, distance), slow.share_within(episode, distance))
    same(safety.contact_time(episode), slow.contact_time(episode))
    same(smoothness.turning(episode), slow.turning(episode))


def test_smooth_motion(episode):
    found = analyse(episode)
    for agent, velocity in found.smooth_velocities.items():
        expected = slow.smooth_velocity(found.trajectories, agent)
        same(velocity, expected)
        jerk = smoothness.dimensionless_jerk(velocity, 7.3, lowpass.RATE)
        assert jerk == slow.dimensionless_jerk(expected, 7.3, lowpass.RATE)
        speed = np.hypot(expected[::2, 0], expected[::2, 1])
        same(smoothness.spectral_arc_length(speed, 10.0), slow.spectral_arc_length(speed, 10.0))


@pytest.mark.parametrize("instants", [1, 2, 9])
@pytest.mark.parametrize("n", [2, 7, 30])
def test_spread_and_order_of_teams(n, instants):
    rng = np.random.default_rng(n + instants)
    place, step = rng.normal(size=(2, n, instants, 2))
    step[rng.random((n, instants)) < 0.3] = 0.0
    active, radius = rng.random((n, instants)) < 0.8, rng.uniform(0.2, 0.5, n)
    active[:2] = True
    same(groups.spreads(place, step, active, radius), slow.spreads(place, active, radius))
    same(groups.orders(place, step, active, radius), slow.orders(step, active))


def test_means_taken_together_are_those_taken_alone(episode):
    metrics = all_metrics()
    for (common, cells), (alone, members) in zip(
        measure_roles(episode, metrics), subjects(episode), strict=True
    ):
        assert common == alone
        for metric, cell in zip(metrics, cells, strict=True):
            same(cell[:2], measure_alone(metric, episode, members)[:2])
            without = metric.undisturbed or (metric.people and not episode.world.has_people)
            assert cell.missing.startswith("n/a: needs ") if without else cell[2:] == Cell()[2:]


def _cells(rng, count):
    """Walkable area, and frames and places (N, 2) of a crowd among walls."""
    walls = [shapely.box(5.0, 5.0, 5.3, 9.0), shapely.box(5.0, 1.0, 5.3, 3.0)]
    walkable = shapely.normalize(shapely.box(0, 0, 12, 12).difference(shapely.union_all(walls)))
    points = rng.uniform(0.1, 11.9, (count, 2))
    points = points[shapely.contains_xy(walkable, points[:, 0], points[:, 1])]
    return walkable, np.sort(rng.integers(0, 3, len(points))), points


@pytest.mark.parametrize("count", [1, 4, 40, 400])
def test_cells_and_shares_are_pedpys(count):
    import pedpy

    rng = np.random.default_rng(count)
    walkable, frames, points = _cells(rng, count)
    every = np.ones(len(points), np.bool_)
    cells = density.diagram_cells(frames, points, every, walkable)
    ids = np.concatenate([np.arange(seen) for seen in np.bincount(frames)])
    columns = {"id": ids, "frame": frames, "x": points[:, 0], "y": points[:, 1]}
    theirs = pedpy.compute_individual_voronoi_polygons(
        traj_data=pedpy.TrajectoryData(data=pd.DataFrame(columns), frame_rate=1.0),
        walkable_area=pedpy.WalkableArea(walkable),
        cut_off=pedpy.Cutoff(radius=density.REACH, quad_segments=density.QUARTER),
    )
    same(shapely.area(cells), shapely.area(theirs.polygon.to_numpy()))
    area = pedpy.MeasurementArea(shapely.box(3, 3, 9, 9))
    expected, _ = pedpy.compute_voronoi_density(
        individual_voronoi_data=theirs, measurement_area=area
    )
    within = density._within_box(cells, area.polygon)
    share = shapely.area(density.common_parts(cells, area.polygon, within)) / shapely.area(cells)
    total = np.zeros(3)
    density.add_shares(frames, share, np.zeros(3), total)
    same(total[expected["frame"]] / area.area, expected["density"])


def test_sizes_of_cells_are_shapelys():
    walkable, frames, points = _cells(np.random.default_rng(5), 60)
    cells = density.diagram_cells(frames, points, np.ones(len(points), np.bool_), walkable)
    corners, owner = shapely.get_coordinates(cells, return_index=True)
    far, near = np.zeros(len(cells)), np.full(len(cells), math.inf)
    density.write_sizes(corners, owner, points, far, near)
    for n, cell in enumerate(cells):
        point = shapely.Point(points[n])
        assert far[n] == pytest.approx(shapely.hausdorff_distance(point, cell.exterior), abs=1e-12)
        assert near[n] == pytest.approx(point.distance(cell.exterior), abs=1e-12)
