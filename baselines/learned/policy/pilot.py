"""A policy of another library as a pilot of many rows."""

from collections.abc import Sequence

import numpy as np

from benchnav.arena import Sensing
from benchnav.arrays import FloatArray, IntArray
from benchnav.envs import Bodies
from benchnav.navigation import Briefing, Need, Observation, RowTable, Training

from ...common.policy_runner import Pilot
from ...common.ray_fit import why_rays_do_not_fit
from .loading import PolicyConfig, load_policy

_LIMITS = ("radius", "max_speed", "max_turn_rate")


class PolicyFilePilot(Pilot):
    """Encodes observations and executes actions as the learning environments do."""

    def __init__(self, config: PolicyConfig) -> None:
        self._policy = load_policy(config)
        self._kept = RowTable()

    @property
    def needs(self) -> frozenset[Need]:
        return self._policy.encoder.needs

    @property
    def training(self) -> Training | None:
        return self._policy.training

    @property
    def fingerprint(self) -> str:
        return self._policy.sha256

    def unfit(self, sensing: Sensing) -> str:
        return why_rays_do_not_fit(self._policy.encoder, sensing)

    def reset(self, briefings: Sequence[Briefing], rows: IntArray) -> None:
        for row, briefing in zip(rows.tolist(), briefings, strict=True):
            self._kept.put(
                row,
                memory=np.zeros((len(briefing), self._policy.network.state_size), np.float32),
                tolerance=np.full(len(briefing), briefing.goal_tolerance),
                reverse=briefing.reverse,
                **{name: getattr(briefing, name) for name in _LIMITS},
            )

    def tolerance(self, observation: Observation) -> FloatArray:
        return self._of("tolerance", observation)

    def twists(self, observation: Observation, tolerance: FloatArray) -> FloatArray:
        active, rows = observation.active, observation.rows
        radius, speed, turn = (self._of(name, observation) for name in _LIMITS)
        encoded = self._policy.encoder.encode(observation, Bodies(radius, speed, turn))
        memory = self._of("memory", observation).copy()
        now = memory[active]
        action = np.zeros((*active.shape, 2))
        action[active] = self._policy.actions(encoded[active], now)
        memory[active] = now
        self._kept.write("memory", rows, memory)
        forward = 0.5 * (action[..., 0] + 1.0)
        pace = np.where(self._of("reverse", observation), action[..., 0], forward)
        return np.stack([pace * speed, action[..., 1] * turn], axis=-1)

    def _of(self, name: str, observation: Observation) -> FloatArray:
        values: FloatArray = self._kept.take(name, observation.rows, observation.active.shape[1])
        return values
