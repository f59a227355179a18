"""ORCA towards the goal."""

from collections.abc import Sequence
from typing import ClassVar

from benchnav.arrays import FloatArray, IntArray
from benchnav.navigation import Briefing, Navigator, Need, Observation, PluginConfig

from .avoidance import Avoidance, OrcaConfig


class Orca(Navigator):
    """Optimal reciprocal collision avoidance with the goal as preferred direction.

    Each of two agents makes half of the avoidance; near a dynamic obstacle, which never
    yields, an agent makes all of it. For a unicycle, the simulator converts the velocity
    into forward speed and turn rate.

    A body that cannot take a velocity at once (a car, a differential drive, a body with limits of
    acceleration) gets only velocities that it tracks closely, and a larger disc (NH-ORCA,
    Alonso-Mora et al. 2013). A car that can drive backwards does so where it has no way ahead.
    """

    Config = OrcaConfig
    needs: ClassVar[frozenset[Need]] = frozenset({Need.NEIGHBOURS, Need.EDGES})

    def __init__(self, config: PluginConfig | None = None) -> None:
        super().__init__(config)
        self._avoidance = Avoidance(self.config)

    @property
    def uses_map(self) -> bool:
        return False

    def reset(self, briefings: Sequence[Briefing], rows: IntArray) -> None:
        self._avoidance.reset(briefings, rows)

    def act(self, observation: Observation) -> FloatArray:
        return self._avoidance.velocity(observation, observation.goal)
