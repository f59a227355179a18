"""The planar swept test and FCL must say the same, but within a stated band of the boundary."""

import math
import os
from pathlib import Path

import numpy as np
import pytest

from benchnav.arena.mesh import Mesh
from benchnav.arena.solid import Kind, Solid
from benchnav.navigation.map import Map
from benchnav.navigation.plugin.configure import make
from benchnav.plugins import PLANNERS
from benchnav.scenario.files.mesh_section import SIMPLIFY, THIN, mesh_solids

pytest.importorskip("fcl")
trimesh = pytest.importorskip("trimesh")
from benchnav_baselines.common.mesh_checker import MeshChecker, winding_number  # noqa: E402
from benchnav_baselines.common.validity_checker import PlanarChecker  # noqa: E402

DATA = Path(os.environ.get("BENCHNAV_DATA", Path(__file__).parents[2] / ".." / "shared" / "data"))
EXACT = 2e-5  # [m] what FCL's solver leaves open
OUTLINE = SIMPLIFY + THIN + EXACT  # [m] what cutting a mesh into an outline adds
RADIUS = 0.2
REAL = {
    "hexagon": ("turtlebot3/turtlebot3_world/meshes/hexagon.dae", "z", 0.8, (0.05, 0.4)),
    "wall": ("turtlebot3/turtlebot3_world/meshes/wall.dae", "z", 0.25, (0.05, 0.4)),
    "shelf": (
        "aws/ShelfD_01/aws_robomaker_warehouse_ShelfD_01_collision.DAE",
        None,
        1.0,
        (0.05, 1),
    ),
    "building": (
        "aws/WallB_01/aws_robomaker_warehouse_WallB_01_collision.DAE",
        None,
        1.0,
        (0.05, 1),
    ),
}


def compare(map: Map, tolerance: float, motions: int) -> tuple[int, int]:
    """How many motions were free and blocked; asserts that both checkers agree on all."""
    mesh = MeshChecker(map, RADIUS)
    near, at, far = (PlanarChecker(map, RADIUS + d) for d in (-tolerance, 0.0, tolerance))
    rng = np.random.default_rng(0)
    counts = [0, 0]
    while sum(counts) < motions:
        p = rng.uniform(map.bounds[:2], map.bounds[2:])
        q = p + rng.normal(size=2) * rng.choice([0.0, 0.1, 0.5, 2.0])
        if near.point_is_free(*p) != far.point_is_free(*p):
            continue
        assert mesh.point_is_free(*p) == at.point_is_free(*p), p
        if not at.point_is_free(*p):
            continue
        free = mesh.motion_is_free(*p, *q)
        if far.motion_is_free(*p, *q):
            assert free, (p, q)
        if not near.motion_is_free(*p, *q):
            assert not free, (p, q)
        counts[free] += 1
    return counts[1], counts[0]


def bounds_of(vertices: np.ndarray) -> tuple[float, float, float, float]:
    low, high = vertices[:, :2].min(axis=0) - 1.0, vertices[:, :2].max(axis=0) + 1.0
    return (*low.tolist(), *high.tolist())


@pytest.mark.parametrize("name", REAL)
def test_they_agree_on_meshes_of_others(name):
    file, up, scale, band = REAL[name]
    if not (DATA / "meshes").is_dir():
        pytest.skip(f"no real meshes at {DATA}")
    solids, mesh = mesh_solids(DATA / "meshes" / file, None, up, scale, band)
    free, blocked = compare(Map(bounds_of(mesh.vertices), solids, 0, (mesh,)), OUTLINE, 800)
    assert min(free, blocked) > 50


def test_they_agree_on_a_mesh_of_our_own(tmp_path):
    table = trimesh.util.concatenate(
        [
            trimesh.creation.box(
                (0.3, 0.3, 0.7), trimesh.transformations.translation_matrix((0, 0, 0.35))
            ),
            trimesh.creation.box(
                (2.0, 1.0, 0.1), trimesh.transformations.translation_matrix((0, 0, 0.75))
            ),
            trimesh.creation.icosphere(2, 0.4).apply_translation((1.6, 0.3, 0.4)),
            trimesh.creation.annulus(0.3, 0.5, 1.0).apply_translation((-1.5, 0.2, 0.3)),
        ]
    )
    table.export(tmp_path / "table.ply")
    solids, mesh = mesh_solids(tmp_path / "table.ply", None, None, 1.0, (0.05, 0.6))
    free, blocked = compare(Map(bounds_of(mesh.vertices), solids, 0, (mesh,)), OUTLINE, 2000)
    assert min(free, blocked) > 100


def test_they_agree_on_extruded_solids():
    rng = np.random.default_rng(7)
    square = np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)])
    map = Map(
        (-4.0, -4.0, 4.0, 4.0),
        (
            Solid(Kind.WALL, (8.0 * (square[::-1] - 0.5),)),
            *(Solid(Kind.STATIC, (square + rng.uniform(-4, 3, 2),)) for _ in range(4)),
            Solid(Kind.STATIC, center=(1.0, -1.0), radius=0.4),
            Solid(Kind.WALL, (np.array([(-1.0, -3.0), (1.0, -3.5)]),)),
        ),
    )
    free, blocked = compare(map, EXACT, 2000)
    assert min(free, blocked) > 100


def test_what_a_mesh_has_above_the_band_is_no_obstacle():
    roof = trimesh.creation.box(
        (4.0, 4.0, 0.1), trimesh.transformations.translation_matrix((0, 0, 1.0))
    )
    for band, free in (((0.0, 0.9), True), ((0.0, 1.1), False)):
        map = Map(
            (-5, -5, 5, 5), (), 0, (Mesh(np.array(roof.vertices), np.array(roof.faces), band),)
        )
        assert MeshChecker(map, RADIUS).motion_is_free(-1.0, 0.0, 1.0, 0.0) == free


def test_nothing_tunnels_through_a_thin_sheet():
    sheet = np.array([(0.0, -1.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 2.0)])
    map = Map((-5, -5, 5, 5), (), 0, (Mesh(sheet, np.array([[0, 1, 2]]), (0.1, 0.5)),))
    checker = MeshChecker(map, 0.01)
    assert not checker.motion_is_free(-3.0, 0.0, 3.0, 0.1)
    assert checker.motion_is_free(-3.0, 1.2, 3.0, 1.2)


def test_a_place_inside_a_closed_mesh_is_blocked():
    block = trimesh.creation.box((4.0, 4.0, 2.0))
    vertices, faces = np.array(block.vertices), np.array(block.faces)
    map = Map((-5, -5, 5, 5), (), 0, (Mesh(vertices, faces, (-0.5, 0.5)),))
    checker = MeshChecker(map, RADIUS)
    assert checker.motion_is_free(0.0, 0.0, 0.1, 0.0)  # it touches no triangle
    assert not checker.point_is_free(0.0, 0.0)
    assert checker.point_is_free(3.0, 0.0)
    assert winding_number(np.zeros(3), vertices[faces]) == pytest.approx(1.0)
    assert winding_number(np.array([9.0, 0.0, 0.0]), vertices[faces]) == pytest.approx(0.0)


@pytest.mark.parametrize("name", ["ompl.rrt-connect", "ompl.prm"])
def test_planners_plan_with_it(name):
    column = trimesh.creation.cylinder(1.0, 2.0)
    mesh = Mesh(np.array(column.vertices), np.array(column.faces), (0.0, 0.5))
    map = Map((-4.0, -4.0, 4.0, 4.0), (), 0, (mesh,))
    planner = make(PLANNERS, {"type": name, "checker": "mesh", "iterations": 200})
    ends = np.array([-3.0, 0.0]), np.array([3.0, 0.0])
    found = planner.plan(map, *ends, RADIUS, 0.1, np.random.default_rng(0))
    assert found.solved
    assert math.hypot(6.0, 1.0) < found.length < 8.0
    blind = make(PLANNERS, name).plan(map, *ends, RADIUS, 0.1, np.random.default_rng(0))
    assert blind.length == 6.0  # in the plane the map is empty
