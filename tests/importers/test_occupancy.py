import math

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from benchnav.arena.solid import Kind
from benchnav.errors import MapError
from benchnav.geometry.geodesic import FreeSpace
from benchnav.scenario.files.occupancy import occupancy_solids, read_occupancy, trace
from benchnav.scenario.importers.grid import Occupancy
from tests.importers.data import published

MAP = "type octile\nheight 3\nwidth 4\nmap\n....\n.@@.\n....\n"
grids = arrays(bool, st.tuples(st.integers(1, 8), st.integers(1, 8)))


def grid(blocked, unknown=None, cell=1.0, origin=(0.0, 0.0, 0.0)):
    blocked = np.asarray(blocked, bool)
    unknown = np.zeros_like(blocked) if unknown is None else np.asarray(unknown, bool)
    return Occupancy(blocked, unknown, cell, origin)


def room(solids):
    """What the solids leave free, as one shapely geometry: clockwise loops less the others."""
    loops = [shapely.Polygon(loop) for solid in solids for loop in solid.loops]
    holes = [p for p in loops if not p.exterior.is_ccw]
    fills = [p for p in loops if p.exterior.is_ccw]
    # islands lie in the room, ponds in islands: an odd number of loops around is free
    free = shapely.Polygon()
    for loop in sorted([*holes, *fills], key=lambda p: -p.area):
        free = shapely.symmetric_difference(free, shapely.make_valid(loop))
    return free


def checks(occupancy, solids, offset=(0.0, 0.0), free=None):
    rows, columns = np.indices(occupancy.blocked.shape)
    centres = occupancy.centres(columns, rows) + offset
    inside = shapely.contains_xy(room(solids), centres[..., 0], centres[..., 1])
    return np.array_equal(inside, ~occupancy.blocked if free is None else free)


@settings(deadline=None)  # the first call compiles
@given(grids, st.floats(0.05, 3.0), st.floats(-3.0, 3.0))
def test_a_cell_is_inside_a_solid_where_it_is_blocked(blocked, cell, yaw):
    occupancy = grid(blocked, cell=cell, origin=(1.0, -2.0, yaw))
    solids = trace(occupancy)
    assert checks(occupancy, solids)
    assert all(solid.kind == Kind.WALL for solid in solids)


@settings(deadline=None)  # the first call compiles
@given(grids)
def test_nothing_passes_between_cells_that_touch_at_a_corner(blocked):
    """The smallest disc gets from a free cell to exactly those that 4-connected steps reach."""
    from scipy import ndimage

    label, _ = ndimage.label(~blocked)
    free = np.argwhere(~blocked)
    if len(free) < 2:
        return
    occupancy = grid(blocked)
    space = FreeSpace(np.vstack([s.capsules for s in trace(occupancy)]), 1e-3)
    start = free[0]
    for row, column in free[1:]:
        length = space.length(occupancy.centres(*start[::-1]), occupancy.centres(column, row))
        assert math.isnan(length) == (label[row, column] != label[tuple(start)])


def test_unknown_cells_are_blocked_unless_they_are_called_free():
    blocked, unknown = [[0, 1, 0]], [[0, 0, 1]]
    occupancy = grid(blocked, unknown)
    assert checks(occupancy, trace(occupancy), free=np.array([[True, False, False]]))
    opened = trace(occupancy, unknown_is_free=True)
    assert checks(occupancy, opened, free=np.array([[True, False, True]]))


def test_a_map_stands_where_it_is_put(tmp_path):
    path = tmp_path / "tiny.map"
    path.write_text(MAP)
    solids, bounds = occupancy_solids(path, "movingai", offset=(10.0, 20.0), cell=0.5)
    assert bounds == (10.0, 20.0, 12.0, 21.5)
    outside, block = solids
    assert {tuple(p) for p in block.loops[0]} == {
        (10.5, 20.5), (11.5, 20.5), (11.5, 21.0), (10.5, 21.0)
    }  # fmt: skip
    assert len(block.capsules) == len(outside.capsules) == 4
    assert checks(read_occupancy(path, "movingai", 0.5), solids, (10.0, 20.0))


def test_a_map_without_a_free_cell_and_an_unknown_format_are_refused(tmp_path):
    path = tmp_path / "full.map"
    path.write_text("type octile\nheight 1\nwidth 2\nmap\n@@\n")
    with pytest.raises(MapError, match=r"full\.map:1: the map must have a free cell"):
        occupancy_solids(path, "movingai")
    with pytest.raises(MapError, match="'movingai' or 'ros'; got 'ppm'"):
        occupancy_solids(path, "ppm")


@pytest.mark.parametrize(
    ("name", "format"),
    [
        ("movingai/room-32-32-4.map", "movingai"),
        ("movingai/den312d.map", "movingai"),
        ("ros_maps/testmap.yaml", "ros"),
        ("ros_maps/tb3_sandbox.yaml", "ros"),
    ],
)
def test_published_maps_are_traced_to_the_cell(name, format):
    path = published(name)
    occupancy = read_occupancy(path, format)
    solids, bounds = occupancy_solids(path, format)
    assert checks(occupancy, solids, free=~(occupancy.blocked | occupancy.unknown))
    assert bounds == occupancy.bounds
