"""Navigators whose weights were learned: the paper's, and one that is free to see more."""

import math
from collections.abc import Sequence
from functools import lru_cache
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
from pydantic import Field

from benchnav.arena.sensing import Sensing
from benchnav.arrays import FloatArray, IntArray
from benchnav.envs.encoders.catalogue import encoder
from benchnav.envs.encoders.encoder import Bodies
from benchnav.envs.encoders.paper import RANGE, RAYS
from benchnav.navigation.briefing import Briefing
from benchnav.navigation.navigator import CommandKind, Navigator, Need, PluginConfig, Training
from benchnav.navigation.observation import Observation
from benchnav.navigation.row_table import RowTable

from .actor import Actor
from .foresight import foresee
from .weights import read_weights

SHIPPED = Path(__file__).parent / "weights"
_LIMITS = ("radius", "max_speed", "max_turn_rate")


class RecurrentPPO(Navigator):
    """The paper's method: PPO with LSTM and collision prediction, 7 forward rays.

    Deterministic: the mean of the Gaussian over (forward speed, turn rate).
    """

    class Config(PluginConfig):
        """Which weights."""

        weights: str = Field("", description="file that `benchnav train` wrote; its own if empty")

    command: ClassVar[CommandKind] = "twist"
    shipped: ClassVar[str] = "recurrent-ppo.safetensors"

    def __init__(self, config: PluginConfig | None = None) -> None:
        super().__init__(config)
        path = Path(self.config.weights) if self.config.weights else SHIPPED / self.shipped
        self._actor, self.about = _loaded(path)
        self._encoder = encoder(self.about["encoder"])
        self._kept = RowTable()

    @property
    def required(self) -> frozenset[Need]:
        return self._encoder.needs

    @property
    def training(self) -> Training:
        progress = self.about["progress"]
        return Training(int(progress["decisions"]), float(progress["seconds"]))

    @property
    def fingerprint(self) -> str:
        return str(self.about["sha256"])

    def unfit(self, sensing: Sensing) -> str:
        rays = sensing.rays
        if Need.RAYS not in self.required or rays is None:
            return ""
        like = (rays.count, round(rays.fan, 6), rays.range, rays.thick)
        if like == (RAYS, round(math.pi, 6), RANGE, True):
            return ""
        return (
            f"its encoder {self._encoder.name!r} was made for {RAYS} thick rays over 180° and"
            f" {RANGE:g} m, and agents there have {rays.count}{' thick' if rays.thick else ''}"
            f" over {math.degrees(rays.fan):.0f}° and {rays.range:g} m"
        )

    def reset(self, briefings: Sequence[Briefing], rows: IntArray) -> None:
        for row, briefing in zip(rows, briefings, strict=True):
            memory = np.zeros((len(briefing), self._actor.state_size), np.float32)
            limits = {name: getattr(briefing, name) for name in _LIMITS}
            limits["tolerance"] = np.full(len(briefing), briefing.goal_tolerance)
            self._kept.put(int(row), memory=memory, **limits)

    def act(self, observation: Observation) -> FloatArray:
        active, rows = observation.active, observation.rows
        agents = active.shape[1]
        radius, speed, turn = (self._kept.take(name, rows, agents) for name in _LIMITS)
        encoded = self._encoder.encode(observation, Bodies(radius, speed, turn))
        memory = self._kept.take("memory", rows, agents).copy()
        now = memory[active]
        action = np.clip(self._actor.decide(encoded[active], now).astype(float), -1.0, 1.0)
        memory[active] = now
        self._kept.write("memory", rows, memory)
        command = np.zeros((*active.shape, 2))
        command[active] = action
        command[..., 0] = 0.5 * (command[..., 0] + 1.0) * speed
        command[..., 1] *= turn
        return self.corrected(observation, Bodies(radius, speed, turn), command)

    def corrected(self, seen: Observation, bodies: Bodies, command: FloatArray) -> FloatArray:
        """What becomes of the learned twists; here, nothing."""
        return command


class RecurrentPPOPlus(RecurrentPPO):
    """RecurrentPPO that sees all round, told its neighbours' velocities, and steers smoothly."""

    class Config(RecurrentPPO.Config):
        """Which weights, and whether to look ahead."""

        foresight: bool = Field(True, description="correct twists that would collide")

    shipped: ClassVar[str] = "recurrent-ppo-plus.safetensors"

    def corrected(self, seen: Observation, bodies: Bodies, command: FloatArray) -> FloatArray:
        if not self.config.foresight:
            return command
        tolerance = self._kept.take("tolerance", seen.rows, seen.active.shape[1])
        return foresee(seen, bodies, command, tolerance)


@lru_cache(maxsize=8)
def _read(path: Path, changed: int) -> tuple[Actor, dict[str, Any]]:
    return read_weights(path)


def _loaded(path: Path) -> tuple[Actor, dict[str, Any]]:
    """Read once per state of the file."""
    return _read(path, path.stat().st_mtime_ns if path.is_file() else 0)
