"""A benchmark for crowd navigation in unknown and dynamic environments.

Every name below is loaded when it is first used, so that ``import benchnav`` takes no time.
"""

from typing import TYPE_CHECKING

from benchnav.errors import BenchnavError
from benchnav.lazy_names import lazy_names
from benchnav.plugins import (
    register_controller,
    register_metric,
    register_navigator,
    register_planner,
)

if TYPE_CHECKING:
    from benchnav.api.catalogue import available
    from benchnav.api.comparison import Comparison
    from benchnav.api.curve import Curve
    from benchnav.api.env import make_env
    from benchnav.api.episode import Episode
    from benchnav.api.episodes import Episodes
    from benchnav.api.execution import run
    from benchnav.api.leaderboard import Leaderboard
    from benchnav.api.run import Run, merge, open_run
    from benchnav.api.scenario import Scenario, load_scenario
    from benchnav.api.simulate import simulate
    from benchnav.api.verification import Verification
    from benchnav.api.world import World
else:
    __getattr__ = lazy_names(
        __name__,
        {
            "Comparison": "benchnav.api.comparison",
            "Curve": "benchnav.api.curve",
            "Episode": "benchnav.api.episode",
            "Episodes": "benchnav.api.episodes",
            "Leaderboard": "benchnav.api.leaderboard",
            "Run": "benchnav.api.run",
            "Scenario": "benchnav.api.scenario",
            "Verification": "benchnav.api.verification",
            "World": "benchnav.api.world",
            "available": "benchnav.api.catalogue",
            "load_scenario": "benchnav.api.scenario",
            "make_env": "benchnav.api.env",
            "merge": "benchnav.api.run",
            "open_run": "benchnav.api.run",
            "run": "benchnav.api.execution",
            "simulate": "benchnav.api.simulate",
        },
    )

__version__ = "0.2.0"

__all__ = [
    "BenchnavError",
    "Comparison",
    "Curve",
    "Episode",
    "Episodes",
    "Leaderboard",
    "Run",
    "Scenario",
    "Verification",
    "World",
    "available",
    "load_scenario",
    "make_env",
    "merge",
    "open_run",
    "register_controller",
    "register_metric",
    "register_navigator",
    "register_planner",
    "run",
    "simulate",
]


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
