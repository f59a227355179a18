"""Readers of other projects' files, and the scenarios that are made of them."""

from benchnav.scenario.importers.draft import import_movingai, import_ros_map, write_scenario

__all__ = ["import_movingai", "import_ros_map", "write_scenario"]
