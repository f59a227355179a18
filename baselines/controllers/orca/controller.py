"""ORCA towards the guide's target."""

from collections.abc import Sequence
from typing import ClassVar

from benchnav.arrays import FloatArray, IntArray
from benchnav.navigation import Briefing, Controller, Guide, Need, Observation, PluginConfig

from .avoidance import Avoidance, OrcaConfig


class OrcaController(Controller):
    """Optimal reciprocal collision avoidance with the guide's target as preferred direction.

    At edges it keeps no more distance than its path does. Bodies that cannot take a velocity at
    once are driven as by the navigator `orca`.
    """

    Config = OrcaConfig
    needs: ClassVar[frozenset[Need]] = frozenset({Need.NEIGHBOURS, Need.EDGES})
    adapts_clearance: ClassVar[bool] = True

    def __init__(self, config: PluginConfig | None = None) -> None:
        super().__init__(config)
        self._avoidance = Avoidance(self.config)

    def reset(self, briefings: Sequence[Briefing], rows: IntArray) -> None:
        self._avoidance.reset(briefings, rows)

    def steer(self, observation: Observation, guide: Guide) -> FloatArray:
        return self._avoidance.velocity(observation, guide.target, guide.clearance)
