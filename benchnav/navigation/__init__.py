"""The public names for authors of navigators, planners and controllers.

Import from here; a name is loaded when it is first used.
"""

from typing import TYPE_CHECKING

from benchnav.lazy_names import lazy_names

if TYPE_CHECKING:
    from benchnav.arena.sensing import Sensing
    from benchnav.navigation.agent_view import AgentView
    from benchnav.navigation.briefing import Briefing
    from benchnav.navigation.controller import Controller, Guide
    from benchnav.navigation.hierarchy.hierarchical import Hierarchical
    from benchnav.navigation.map import Map
    from benchnav.navigation.navigator import (
        AgentNavigator,
        CommandKind,
        DynamicsName,
        Navigator,
        Need,
        PluginConfig,
        Training,
    )
    from benchnav.navigation.observation import Observation
    from benchnav.navigation.planner import UNSOLVED, Plan, Planner
    from benchnav.navigation.plugin.configure import Spec
    from benchnav.navigation.randomness.agent_streams import agent_streams, canonical_order
    from benchnav.navigation.rehearsal import Rehearsal
    from benchnav.navigation.row_table import RowTable
    from benchnav.sensors.readings import Edges, Neighbours, Rays
else:
    __getattr__ = lazy_names(
        __name__,
        {
            "AgentNavigator": "benchnav.navigation.navigator",
            "AgentView": "benchnav.navigation.agent_view",
            "Briefing": "benchnav.navigation.briefing",
            "CommandKind": "benchnav.navigation.navigator",
            "Controller": "benchnav.navigation.controller",
            "DynamicsName": "benchnav.navigation.navigator",
            "Edges": "benchnav.sensors.readings",
            "Guide": "benchnav.navigation.controller",
            "Hierarchical": "benchnav.navigation.hierarchy.hierarchical",
            "Map": "benchnav.navigation.map",
            "Navigator": "benchnav.navigation.navigator",
            "Need": "benchnav.navigation.navigator",
            "Neighbours": "benchnav.sensors.readings",
            "Observation": "benchnav.navigation.observation",
            "Plan": "benchnav.navigation.planner",
            "Planner": "benchnav.navigation.planner",
            "PluginConfig": "benchnav.navigation.navigator",
            "Rays": "benchnav.sensors.readings",
            "Rehearsal": "benchnav.navigation.rehearsal",
            "RowTable": "benchnav.navigation.row_table",
            "Sensing": "benchnav.arena.sensing",
            "Spec": "benchnav.navigation.plugin.configure",
            "Training": "benchnav.navigation.navigator",
            "UNSOLVED": "benchnav.navigation.planner",
            "agent_streams": "benchnav.navigation.randomness.agent_streams",
            "canonical_order": "benchnav.navigation.randomness.agent_streams",
        },
    )

__all__ = [
    "UNSOLVED",
    "AgentNavigator",
    "AgentView",
    "Briefing",
    "CommandKind",
    "Controller",
    "DynamicsName",
    "Edges",
    "Guide",
    "Hierarchical",
    "Map",
    "Navigator",
    "Need",
    "Neighbours",
    "Observation",
    "Plan",
    "Planner",
    "PluginConfig",
    "Rays",
    "Rehearsal",
    "RowTable",
    "Sensing",
    "Spec",
    "Training",
    "agent_streams",
    "canonical_order",
]
