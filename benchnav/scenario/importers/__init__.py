"""Readers of other projects' files, and scenarios made from them."""

from benchnav.scenario.importers.bundle import write_scenario
from benchnav.scenario.importers.draft import (
    default_name,
    demand_name,
    import_movingai,
    import_ros_map,
)

__all__ = ["default_name", "demand_name", "import_movingai", "import_ros_map", "write_scenario"]
