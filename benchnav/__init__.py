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
    from benchnav.api.authoring.import_map import import_map
    from benchnav.api.authoring.import_recording import import_recording
    from benchnav.api.authoring.import_world import import_world
    from benchnav.api.authoring.new_package import new_navigator, new_package
    from benchnav.api.authoring.schema import schema
    from benchnav.api.authoring.validate import Validation, validate
    from benchnav.api.components.catalogue import Catalogue, available
    from benchnav.api.components.diagnosis import Diagnosis, doctor
    from benchnav.api.components.page import Page, show
    from benchnav.api.execution.env import make_env
    from benchnav.api.execution.merge import merge
    from benchnav.api.execution.run import run
    from benchnav.api.execution.score import score
    from benchnav.api.execution.simulate import simulate
    from benchnav.api.execution.train import train
    from benchnav.api.records.comparison import Comparison
    from benchnav.api.records.curve import Curve
    from benchnav.api.records.episode import Episode
    from benchnav.api.records.episodes import Episodes
    from benchnav.api.records.leaderboard import Leaderboard
    from benchnav.api.records.run import Run, open_run
    from benchnav.api.records.scenario import Scenario, load_scenario
    from benchnav.api.records.training import Training
    from benchnav.api.records.verification import Verification
    from benchnav.api.records.world import World
    from benchnav.scenario.robots.registry import register_robot
else:
    __getattr__ = lazy_names(
        __name__,
        {
            "Catalogue": "benchnav.api.components.catalogue",
            "Comparison": "benchnav.api.records.comparison",
            "Curve": "benchnav.api.records.curve",
            "Diagnosis": "benchnav.api.components.diagnosis",
            "Episode": "benchnav.api.records.episode",
            "Episodes": "benchnav.api.records.episodes",
            "Leaderboard": "benchnav.api.records.leaderboard",
            "Page": "benchnav.api.components.page",
            "Run": "benchnav.api.records.run",
            "Scenario": "benchnav.api.records.scenario",
            "Training": "benchnav.api.records.training",
            "Validation": "benchnav.api.authoring.validate",
            "Verification": "benchnav.api.records.verification",
            "World": "benchnav.api.records.world",
            "available": "benchnav.api.components.catalogue",
            "doctor": "benchnav.api.components.diagnosis",
            "import_map": "benchnav.api.authoring.import_map",
            "import_recording": "benchnav.api.authoring.import_recording",
            "import_world": "benchnav.api.authoring.import_world",
            "load_scenario": "benchnav.api.records.scenario",
            "make_env": "benchnav.api.execution.env",
            "merge": "benchnav.api.execution.merge",
            "new_navigator": "benchnav.api.authoring.new_package",
            "new_package": "benchnav.api.authoring.new_package",
            "open_run": "benchnav.api.records.run",
            "register_robot": "benchnav.scenario.robots.registry",
            "run": "benchnav.api.execution.run",
            "schema": "benchnav.api.authoring.schema",
            "score": "benchnav.api.execution.score",
            "show": "benchnav.api.components.page",
            "simulate": "benchnav.api.execution.simulate",
            "train": "benchnav.api.execution.train",
            "validate": "benchnav.api.authoring.validate",
        },
    )

__version__ = "0.3.0.dev0"

__all__ = [
    "BenchnavError",
    "Catalogue",
    "Comparison",
    "Curve",
    "Diagnosis",
    "Episode",
    "Episodes",
    "Leaderboard",
    "Page",
    "Run",
    "Scenario",
    "Training",
    "Validation",
    "Verification",
    "World",
    "available",
    "doctor",
    "import_map",
    "import_recording",
    "import_world",
    "load_scenario",
    "make_env",
    "merge",
    "new_navigator",
    "new_package",
    "open_run",
    "register_controller",
    "register_metric",
    "register_navigator",
    "register_planner",
    "register_robot",
    "run",
    "schema",
    "score",
    "show",
    "simulate",
    "train",
    "validate",
]


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
