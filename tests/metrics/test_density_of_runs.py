"""Voronoi density against PedPy itself, called on recordings and on simulated crowds."""

import math
import os
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import shapely

from benchnav.generation.build import build
from benchnav.metrics import congestion
from benchnav.metrics.quantities import density
from benchnav.metrics.quantities.episode_analysis import analyse
from benchnav.runner.rollouts.rollout import Assignment, rollout
from benchnav.scenario.catalogue import find
from benchnav.scenario.files.track_file import read_tracks
from benchnav.scenario.law import RecordedTrack
from benchnav.testing.episodes import Setting, Walk, record, room

DATA = Path(os.environ.get("BENCHNAV_DATA", Path(__file__).parents[3] / "shared" / "data"))


def pedpys(rows, walkable, area):
    """PedPy's own density of (id, frame, x, y), with cells below 2 m²."""
    import pedpy

    data = pd.DataFrame(rows, columns=["id", "frame", "x", "y"])
    cells = pedpy.compute_individual_voronoi_polygons(
        traj_data=pedpy.TrajectoryData(data=data, frame_rate=1.0),
        walkable_area=pedpy.WalkableArea(walkable),
        cut_off=pedpy.Cutoff(radius=0.8, quad_segments=16),
    )
    found, _ = pedpy.compute_voronoi_density(
        individual_voronoi_data=cells,
        measurement_area=pedpy.MeasurementArea(shapely.box(*area)),
    )
    return found.set_index("frame")["density"]


def simulated(name, seed=0):
    scenario = find(name)
    who = Assignment(scenario.identity, scenario.hash, "validation", "known", "orca", "orca")
    ((episode,),) = rollout(who, [(seed, build(scenario, "validation", seed))])
    return episode


def states_each_second(episode):
    """(id, frame, x, y) of every fifth state (dt is 0.2 s), of those who have not vanished."""
    assert episode.world.clock.dt == 0.2
    rows = []
    for frame, k in enumerate(range(0, len(episode.position), 5)):
        here = np.flatnonzero(~(episode.arrival < 0.2 * k))
        rows += [(agent, frame, *episode.position[k, agent]) for agent in here]
    return rows


def test_density_of_a_simulated_crowd_among_obstacles_is_pedpys():
    """Everybody, the whole hall less its cubes, no agent left out: the same figures."""
    episode = simulated("groups/diagonal:followers=9")
    world = episode.world
    free = shapely.box(*world.bounds)
    for solid in world.solids[1:]:
        free = free.difference(shapely.Polygon(solid.loops[0]).buffer(1e-3))
    expected = pedpys(states_each_second(episode), free, world.measurement_area)
    found = analyse(episode).density
    assert expected.max() > 0.4
    busy = expected.index.to_numpy()
    np.testing.assert_allclose(found[busy], expected, rtol=1e-4, atol=1e-6)
    assert found.sum() == pytest.approx(expected.sum(), rel=1e-4)
    members = np.ones(len(world.agents), bool)
    assert congestion.density_peak(episode, members) == pytest.approx(expected.max(), rel=1e-4)


def test_density_of_a_published_recording_is_pedpys():
    """The tracks of a TrajNet++ file, all at once, walked as they were recorded."""
    path = DATA / "trajnetpp" / "collision_test.ndjson"
    if not path.exists():
        pytest.skip(f"no recordings in {path.parent}: set BENCHNAV_DATA")
    law = RecordedTrack(
        type="recorded-track", file=path.name, format="trajnetpp", frame_time=0.5, ids=None
    )
    tracks = [t for t in read_tracks(law, path.parent) if len(t) > 1]
    assert len(tracks) >= 2
    places = np.vstack([t[:, 1:] for t in tracks])
    low, high = places.min(axis=0) - 2.0, places.max(axis=0) + 2.0
    bounds = (*map(float, low), *map(float, high))
    area = (*map(float, low + 1.5), *map(float, high - 1.5))
    last = max(float(t[-1, 0]) for t in tracks)
    horizon = 0.5 * math.floor(last / 0.5)

    def walk(track):  # who is not there yet stands where it came from, who is gone where it went
        def way(t):
            return np.stack([np.interp(t, track[:, 0], track[:, k]) for k in (1, 2)], axis=1)

        return Walk(way, (1e4, 1e4), radius=0.1)

    setting = Setting(dt=0.5, horizon=horizon, bounds=bounds, solids=(room(bounds),), area=area)
    episode = record([walk(track) for track in tracks], setting)
    rows = [
        (agent, frame, *episode.position[k, agent])
        for frame, k in enumerate(range(0, len(episode.position), 2))
        for agent in range(len(tracks))
    ]
    expected = pedpys(rows, shapely.box(*bounds), area)
    assert expected.max() > 0.0
    # walls have a skin of 1 mm, within which cells end
    np.testing.assert_allclose(analyse(episode).density, expected, rtol=2e-3, atol=1e-6)


# fmt: off
SYMMETRIC = [  # a frame of circle/antipodal, about whose centre some cells have corners at 1e-33
    (1.1449999999999996, -0.125), (1.8750000000000004, 0.12500000000000006),
    (0.6309702691821313, 1.4674846312611278), (0.125, 1.1449999999999996),
    (-1.8749999999999998, 0.8750000000000001), (-0.625, 1.8850000000000002), (-1.375, 1.625),
    (-2.205294372515229, -0.5447056274847712), (-1.1449999999999996, 0.125),
    (-1.9826394002987233, -1.3823194113852912), (-1.5355887450304575, -0.5355887450304574),
    (-0.1791567162802224, -1.6670488494624462), (-0.6249999999999999, -2.1250000000000004),
    (0.125, -1.1449999999999996), (-1.0447056274847712, -2.705294372515229),
    (1.4674846312611285, -0.6309702691821308),
]
# fmt: on


def test_density_of_a_symmetric_crowd_is_that_of_one_a_little_aside(monkeypatch):
    episode = simulated("circle/antipodal")
    trajectories, found = analyse(episode).trajectories, []
    for aside in (0.0, 1e-6):
        points = np.array(SYMMETRIC) + np.array([aside, 0.5 * aside])
        seen = np.arange(len(points)), np.zeros(len(points), np.int64), points
        monkeypatch.setattr(density, "bodies_at", lambda *_, seen=seen: seen)
        found.append(density.voronoi_density(episode.world, trajectories)[0])
    assert found[0] == pytest.approx(found[1], abs=1e-5)
    assert found[0] > 0.5


# fmt: off
GRID = [  # nearly on a grid: GEOS 3.13 cannot cut its own Voronoi diagram of them
    (-0.9991180787356626, 1.7995286032631554), (-0.5991180787356569, 0.5995286032631668),
    (0.6008819212643459, 0.9995286032631725), (0.6008819212643459, 1.7995286032631554),
    (1.8008819212643346, 0.9995286032631725),
]
# fmt: on


def test_density_of_agents_nearly_on_a_grid_is_that_of_agents_a_little_aside(monkeypatch):
    bounds = (-4.0, -4.0, 4.0, 4.0)
    setting = Setting(
        dt=0.5, horizon=1.0, bounds=bounds, solids=(room(bounds),), area=(-2.0, -1.0, 2.0, 3.0)
    )
    stand = Walk(lambda t: np.zeros((len(t), 2)), (3.0, 3.0), radius=0.1)
    episode, found = record([stand], setting), []
    for aside in (0.0, 1e-6):
        points = np.array(GRID) + aside * np.arange(5)[:, None] ** 2
        seen = np.arange(len(points)), np.zeros(len(points), np.int64), points
        monkeypatch.setattr(density, "bodies_at", lambda *_, seen=seen: seen)
        found.append(density.voronoi_density(episode.world, analyse(episode).trajectories)[0])
    assert found[0] == pytest.approx(found[1], abs=1e-5)
    assert found[0] > 0.1


def test_cells_by_half_planes_are_those_of_diagrams():
    rng = np.random.default_rng(0)
    wall = shapely.box(2.0, 1.0, 2.05, 4.0)
    free = shapely.box(0, 0, 6, 5).difference(wall)
    for _ in range(20):
        points = rng.uniform((0, 0), (6, 5), (12, 2))
        points = points[shapely.contains_xy(free, points[:, 0], points[:, 1])]
        frames, inside = np.arange(len(points)) // 6, points[:, 0] > 1.0
        theirs = density.diagram_cells(frames, points, inside, free)
        own = density.half_plane_cells(frames, points, inside, free)
        assert shapely.area(shapely.symmetric_difference(theirs, own)).max() < 1e-9
        np.testing.assert_allclose(shapely.area(own), shapely.area(theirs), rtol=1e-9)
