"""Two controllers in one: ORCA where its assumptions hold, otherwise a learned policy."""

from collections.abc import Sequence
from dataclasses import replace
from typing import ClassVar

import numpy as np
from pydantic import Field

from benchnav.arena import Dynamics, Kind, Sensing
from benchnav.arrays import BoolArray, FloatArray, IntArray
from benchnav.navigation import (
    Briefing,
    Controller,
    DynamicsName,
    Guide,
    Need,
    Observation,
    PluginConfig,
    RowTable,
    Training,
)

from ..common.policy_runner import TURN_ON_THE_SPOT
from ..common.twist_conversion import as_velocity
from ..learned.recurrent_ppo.controller import RecurrentPPOPlusController
from ..learned.recurrent_ppo.detour import CROWD, in_crowd
from ..learned.recurrent_ppo.policy_at_work import CorrectedConfig
from .orca.avoidance import OrcaConfig
from .orca.controller import OrcaController


class OrcaPpoConfig(PluginConfig):
    """Parameters of both, and of the choice between them."""

    orca: OrcaConfig = Field(
        OrcaConfig(time_horizon=3.0, edge_margin=0.02), description="parameters of ORCA"
    )
    policy: CorrectedConfig = Field(
        CorrectedConfig(), description="parameters of `recurrent-ppo-plus`"
    )
    memory: float = Field(
        5.0,
        ge=0,
        description="[s] for which the policy still drives after a dynamic obstacle was sensed",
    )
    detour: float = Field(
        0.5,
        ge=0,
        description="[m] a path is a detour if it is longer than the straight line by more than"
        " this; on a detour the policy drives to waypoints, and not because of a crowd",
    )
    crowd: float = Field(
        5.0,
        ge=0,
        description=f"[m] an agent with {CROWD} or more others within this distance is in a crowd",
    )


class _Policy(RecurrentPPOPlusController):
    """`recurrent-ppo-plus` as a controller, corrected for agents behind it as well."""

    agents_behind: ClassVar[bool] = True


class OrcaPpo(Controller):
    """Decides at each step which controller drives each agent.

    ORCA assumes that a body can execute its commands, and that others avoid it too. The policy of
    `recurrent-ppo-plus` learned on unicycles, among obstacles that never yield, and in crowds.
    Therefore it drives unicycles and differential drives, agents that have just sensed a dynamic
    obstacle, and agents in a crowd whose path is no detour. ORCA drives the others. The policy is
    better with goals than with waypoints, and avoids obstacles itself: unless the path is a detour,
    its target is the goal.
    """

    Config = OrcaPpoConfig
    drives: ClassVar[frozenset[DynamicsName]] = TURN_ON_THE_SPOT
    adapts_clearance: ClassVar[bool] = True

    def __init__(self, config: PluginConfig | None = None) -> None:
        super().__init__(config)
        self._orca = OrcaController(self.config.orca)
        self._policy = _Policy(self.config.policy)
        self._kept = RowTable()

    @property
    def required(self) -> frozenset[Need]:
        return self._orca.required | self._policy.required

    @property
    def training(self) -> Training | None:
        return self._policy.training

    @property
    def fingerprint(self) -> str:
        return self._policy.fingerprint

    def unfit(self, sensing: Sensing) -> str:
        return self._policy.unfit(sensing)

    def reset(self, briefings: Sequence[Briefing], rows: IntArray) -> None:
        self._orca.reset(briefings, rows)
        self._policy.reset(briefings, rows)
        for row, briefing in zip(rows.tolist(), briefings, strict=True):
            self._kept.put(
                row,
                turning=briefing.dynamics != Dynamics.HOLONOMIC,
                dt=np.full(len(briefing), briefing.dt),
                wary=np.full(len(briefing), -np.inf),  # [s] end of wariness
            )

    def steer(self, observation: Observation, guide: Guide) -> FloatArray:
        rows, agents = observation.rows, observation.active.shape[1]
        turning, dt = (self._kept.take(name, rows, agents) for name in ("turning", "dt"))
        direct = self._direct(observation, guide)
        crowded = direct & in_crowd(observation, self.config.crowd)
        learned = observation.active & (turning | self._wary(observation) | crowded)
        velocity = np.zeros((*learned.shape, 2))
        other = observation.active & ~learned
        if other.any():
            velocity = self._orca.steer(replace(observation, active=other), guide)
        if learned.any():
            target = np.where(direct[..., None], observation.goal, guide.target)
            shown = replace(guide, target=target)
            twist = self._policy.steer(replace(observation, active=learned), shown)
            as_velocity(learned, turning, observation.heading, dt, twist, velocity)
        return velocity

    def _wary(self, observation: Observation) -> BoolArray:
        """Whether each agent has just sensed a dynamic obstacle, (B, A)."""
        rows, agents = observation.rows, observation.active.shape[1]
        time = observation.time[:, None]
        near = observation.neighbours
        assert near is not None  # noqa: S101 - both parts declare them
        listed = np.arange(near.kind.shape[2]) < near.count[..., None]
        mover = np.any(listed & (near.kind == Kind.DYNAMIC), axis=-1)
        until = self._kept.take("wary", rows, agents)
        until = np.where(mover, time + self.config.memory, until)
        self._kept.write("wary", rows, until)
        wary: BoolArray = time <= until
        return wary

    def _direct(self, observation: Observation, guide: Guide) -> BoolArray:
        """Whether the path of each agent (B, A) is no detour."""
        way = observation.goal - observation.position
        straight = np.sqrt(np.sum(way * way, axis=-1))
        direct: BoolArray = guide.remaining - straight <= self.config.detour
        return direct
