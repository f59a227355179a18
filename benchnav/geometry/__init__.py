"""Pure functions on arrays: no state, no randomness, no input or output.

A name is loaded when it is first used.
"""

from typing import TYPE_CHECKING

from benchnav.lazy_names import lazy_names

if TYPE_CHECKING:
    from benchnav.geometry.capsule import nearest_on_segment
    from benchnav.geometry.capsule_grid import CapsuleGrid, doubled, is_clear
    from benchnav.geometry.geodesic import FreeSpace
    from benchnav.geometry.rotation import angle_of, cos_sin
    from benchnav.geometry.row_index import SolidRows, inside_rows, solid_rows
    from benchnav.geometry.sweep import inside_solid, segment_distance2, solid_index
else:
    __getattr__ = lazy_names(
        __name__,
        {
            "CapsuleGrid": "benchnav.geometry.capsule_grid",
            "FreeSpace": "benchnav.geometry.geodesic",
            "SolidRows": "benchnav.geometry.row_index",
            "angle_of": "benchnav.geometry.rotation",
            "cos_sin": "benchnav.geometry.rotation",
            "inside_rows": "benchnav.geometry.row_index",
            "inside_solid": "benchnav.geometry.sweep",
            "is_clear": "benchnav.geometry.capsule_grid",
            "doubled": "benchnav.geometry.capsule_grid",
            "nearest_on_segment": "benchnav.geometry.capsule",
            "segment_distance2": "benchnav.geometry.sweep",
            "solid_index": "benchnav.geometry.sweep",
            "solid_rows": "benchnav.geometry.row_index",
        },
    )

__all__ = [
    "CapsuleGrid",
    "FreeSpace",
    "SolidRows",
    "angle_of",
    "cos_sin",
    "doubled",
    "inside_rows",
    "inside_solid",
    "is_clear",
    "nearest_on_segment",
    "segment_distance2",
    "solid_index",
    "solid_rows",
]
