"""Crowd navigation in unknown and dynamic environments, measured alike for everybody."""

from benchnav.errors import BenchnavError
from benchnav.plugins import (
    register_controller,
    register_metric,
    register_navigator,
    register_planner,
)

__version__ = "0.1.0"

__all__ = [
    "BenchnavError",
    "register_controller",
    "register_metric",
    "register_navigator",
    "register_planner",
]
