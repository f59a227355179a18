import math
import sys

import numpy as np
import pytest

from benchnav.arena.solid import Kind
from benchnav.errors import MeshError, MissingExtraError
from benchnav.scenario.files.mesh_section import mesh_solids
from tests.importers.data import published

trimesh = pytest.importorskip("trimesh", reason="needs the extra [plan]")
BAND = (0.05, 0.5)


def area(solids):
    total = 0.0
    for solid in solids:
        for loop in solid.loops:
            x, y = loop.T
            total += 0.5 * float((x * np.roll(y, -1) - y * np.roll(x, -1)).sum())
    return total


def put(tmp_path, *meshes, name="mesh.stl"):
    path = tmp_path / name
    trimesh.util.concatenate(meshes).export(path)
    return path


def box(size, at=(0.0, 0.0, 0.0)):
    return trimesh.creation.box(size, trimesh.transformations.translation_matrix(at))


def section_area(path, unit, height, scale=1.0, up_is_y=False):
    """What trimesh itself cuts at a height [m], in m²."""
    mesh = trimesh.load_scene(path).to_mesh()
    vertices = mesh.vertices * unit * scale
    if up_is_y:
        vertices = np.column_stack([vertices[:, 0], -vertices[:, 2], vertices[:, 1]])
    mesh = trimesh.Trimesh(vertices, mesh.faces)
    mesh.merge_vertices(merge_norm=True, merge_tex=True)
    path3 = mesh.section([0, 0, 1], [0, 0, height])
    return float(path3.to_2D()[0].area)


def test_a_box_is_its_plan_view(tmp_path):
    path = put(tmp_path, box((2.0, 1.0, 4.0)))
    solids, mesh = mesh_solids(path, None, None, 1.0, BAND, at=(3.0, 4.0))
    (solid,) = solids
    assert solid.kind == Kind.STATIC
    corners = sorted(map(tuple, np.round(solid.loops[0], 6).tolist()))
    assert corners == [(2.0, 3.5), (2.0, 4.5), (4.0, 3.5), (4.0, 4.5)]
    assert area(solids) == pytest.approx(2.0)  # counter-clockwise
    assert mesh.band == BAND
    assert mesh.vertices.min(axis=0) == pytest.approx([2.0, 3.5, -2.0])
    assert len(mesh.faces) == 12


def test_unit_scale_axis_and_turn(tmp_path):
    path = put(tmp_path, box((200.0, 400.0, 100.0), (0.0, 200.0, 0.0)))  # y is up, centimetres
    solids, mesh = mesh_solids(path, 0.01, "y", (1.0, 1.0, 3.0), BAND, math.pi / 2, (0, 0, -1.0))
    assert np.ptp(solids[0].loops[0], axis=0) == pytest.approx([3.0, 2.0])
    assert np.ptp(mesh.vertices[:, 2]) == pytest.approx(4.0)
    assert mesh.vertices[:, 2].min() == pytest.approx(-1.0)
    lying, _ = mesh_solids(path, 0.01, "x", 1.0, BAND)
    assert np.ptp(lying[0].loops[0], axis=0) == pytest.approx([1.0, 4.0])


def test_only_what_lies_within_the_band_counts(tmp_path):
    leg, top = box((0.1, 0.1, 0.7), (0, 0, 0.35)), box((2.0, 1.0, 0.05), (0, 0, 0.725))
    path = put(tmp_path, leg, top)
    assert area(mesh_solids(path, None, None, 1.0, (0.05, 0.6))[0]) == pytest.approx(0.01)
    assert area(mesh_solids(path, None, None, 1.0, (0.05, 0.72))[0]) == pytest.approx(2.0)
    assert area(mesh_solids(path, None, None, 1.0, (0.71, 0.72))[0]) == pytest.approx(2.0)
    assert area(mesh_solids(path, None, None, 1.0, (0.05, 0.69))[0]) == pytest.approx(0.01)


def test_a_band_inside_a_cone_has_the_widest_section(tmp_path):
    path = put(tmp_path, trimesh.creation.cone(radius=1.0, height=1.0, sections=64))
    solids, _ = mesh_solids(path, None, None, 1.0, (0.5, 0.9))
    polygon = 0.5 * 64 * math.sin(2 * math.pi / 64)  # of the 64-gon of radius 1
    assert area(solids) == pytest.approx(0.25 * polygon, abs=2e-3)


def test_a_pipe_stays_hollow_and_what_is_in_it_stands_alone(tmp_path):
    pipe = trimesh.creation.annulus(r_min=1.0, r_max=2.0, height=2.0, sections=48)
    solids, _ = mesh_solids(put(tmp_path, pipe, box((0.5, 0.5, 1.0))), None, None, 1.0, (0.0, 0.3))
    assert sorted(len(solid.loops) for solid in solids) == [1, 2]
    ngon = 0.5 * 48 * math.sin(2 * math.pi / 48)
    assert area(solids) == pytest.approx(3.0 * ngon + 0.25, rel=1e-2)


def test_parts_that_overlap_are_one(tmp_path):
    path = put(tmp_path, box((2.0, 1.0, 1.0)), box((1.0, 2.0, 1.0)))
    solids, _ = mesh_solids(path, None, None, 1.0, (0.0, 0.3))
    assert len(solids) == 1
    assert area(solids) == pytest.approx(3.0)
    assert len(solids[0].loops[0]) == 12


def test_a_sheet_becomes_a_thin_wall(tmp_path):
    vertices = [[0, 0, 0], [3, 0, 0], [3, 0, 1], [0, 0, 1]]
    sheet = trimesh.Trimesh(vertices, [[0, 1, 2], [0, 2, 3]])
    solids, _ = mesh_solids(put(tmp_path, sheet), None, None, 1.0, BAND)
    assert area(solids) == pytest.approx(3.0 * 0.002, rel=0.01)


def test_the_mesh_of_a_turned_section_is_turned_with_it(tmp_path):
    path = put(tmp_path, box((2.0, 1.0, 1.0)))
    (solid,), mesh = mesh_solids(path, None, None, 1.0, (0.0, 0.3), 0.7, (5.0, -1.0))
    assert solid.loops[0].min(axis=0) == pytest.approx(mesh.vertices[:, :2].min(axis=0), abs=2e-3)
    assert solid.loops[0].max(axis=0) == pytest.approx(mesh.vertices[:, :2].max(axis=0), abs=2e-3)


def test_nothing_in_the_band_says_where_the_mesh_is(tmp_path):
    path = put(tmp_path, box((1.0, 1.0, 1.0), (0, 0, 5.0)))
    with pytest.raises(MeshError, match=r"between 0\.05 m and 0\.5 m; it spans 4\.5 m to 5\.5 m"):
        mesh_solids(path, None, None, 1.0, BAND)


@pytest.mark.parametrize(
    ("name", "content", "says"),
    [
        ("mesh.txt", b"", "must end in one of .dae, .obj, .off, .ply, .stl; got '.txt'"),
        ("mesh.dae", b"", "a mesh that trimesh reads"),
        ("mesh.dae", b"<COLLADA/>", "mesh"),
        ("mesh.dae", b"<!DOCTYPE x [<!ENTITY a 'b'>]><COLLADA/>", "may not define XML entities"),
        ("mesh.stl", b"type octile\nheight 1\nwidth 1\nmap\n.\n", "mesh"),
        ("mesh.stl", b"\0" * 80 + b"\xff\xff\xff\x7f", "mesh"),
        ("mesh.ply", b"ply\nformat ascii 1.0\nelement vertex 99999999999\n", "mesh"),
        ("mesh.obj", b"v 0 0 0\nv nan 0 0\nv 1 1 1\nf 1 2 3\n", "mesh"),
        ("mesh.obj", b"v 0 0 0\n", "mesh"),
    ],
)
def test_what_is_not_a_mesh_is_refused_by_name(tmp_path, name, content, says):
    path = tmp_path / name
    path.write_bytes(content)
    with pytest.raises(MeshError) as error:
        mesh_solids(path, None, None, 1.0, BAND)
    assert str(path) in str(error.value)
    assert says in str(error.value)


def test_a_missing_mesh_is_refused(tmp_path):
    with pytest.raises(MeshError, match=r"no\.stl:1: the mesh cannot be read"):
        mesh_solids(tmp_path / "no.stl", None, None, 1.0, BAND)


def test_without_the_extra_the_error_says_what_to_install(tmp_path, monkeypatch):
    path = put(tmp_path, box((1.0, 1.0, 1.0)))
    monkeypatch.setitem(sys.modules, "trimesh", None)
    with pytest.raises(MissingExtraError, match=r"pip install 'benchnav\[plan\]'"):
        mesh_solids(path, None, None, 1.0, BAND)


TURTLEBOT = "meshes/turtlebot3/turtlebot3_world/meshes"
AWS = "meshes/aws/{0}/aws_robomaker_warehouse_{0}_collision.DAE"


def test_the_published_hexagon_is_a_hexagon():
    path = published(f"{TURTLEBOT}/hexagon.dae")
    solids, mesh = mesh_solids(path, 1.0, "z", 0.01, BAND)  # what its SDF makes of it, about
    assert [len(loop) for loop in solids[0].loops] == [6]
    assert area(solids) == pytest.approx(section_area(path, 0.01, 0.3), rel=1e-3)
    assert mesh.vertices[:, 2].max() == pytest.approx(1.0)
    inches, _ = mesh_solids(path, None, "z", 1.0, BAND)  # as the file declares
    assert area(inches) == pytest.approx(2.54**2 * area(solids), rel=1e-3)
    flat, _ = mesh_solids(path, None, None, 1.0, BAND)  # declared Y_UP: it lies on its side
    widest = 2 * (57.735 * 0.0254 - BAND[0] * 28.8675 / 50)  # it narrows upwards from its middle
    assert np.ptp(flat[0].loops[0], axis=0) == pytest.approx([widest, 2.54], abs=1e-2)


def test_the_published_wall_is_a_ring():
    path = published(f"{TURTLEBOT}/wall.dae")
    solids, _ = mesh_solids(path, 0.0254, "z", 0.25, BAND)
    assert [len(loop) for loop in solids[0].loops] == [6, 6]
    assert area(solids) == pytest.approx(section_area(path, 0.0254, 0.3, 0.25), rel=1e-2)


def test_the_published_hulls_are_in_metres_with_room_between_them():
    shelf, _ = mesh_solids(published(AWS.format("ShelfD_01")), None, None, 1.0, BAND)
    assert len(shelf) == 3  # its uprights; the boards are above the band or below
    wide = np.ptp(np.vstack([s.loops[0] for s in shelf]), axis=0)
    assert wide == pytest.approx([3.92, 0.88], abs=0.01)
    path = published(AWS.format("WallB_01"))
    wall, _ = mesh_solids(path, None, None, 1.0, BAND)
    assert [len(loop) for loop in wall[0].loops] == [4, 4]
    assert area(wall) == pytest.approx(section_area(path, 0.01, 0.3), rel=1e-2)
