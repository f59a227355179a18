"""The policy as a pilot of many rows."""

from collections.abc import Sequence
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import Field

from benchnav.arena import Sensing
from benchnav.arrays import FloatArray, IntArray
from benchnav.envs import Bodies, encoder
from benchnav.navigation import Briefing, Need, Observation, PluginConfig, RowTable, Training

from ...common.policy_runner import Pilot
from ...common.ray_fit import why_rays_do_not_fit
from .actor import Actor
from .dash import dash
from .detour import Detours
from .foresight import HELD, foresee
from .progress import Progress
from .sightings import NEEDS, Sightings, without_agents_behind
from .weights import read_weights

SHIPPED = Path(__file__).parent / "weights"
SUFFIX = ".safetensors"
_LIMITS = ("radius", "max_speed", "max_turn_rate")


class PolicyConfig(PluginConfig):
    """The choice of weights."""

    weights: str = Field(
        "",
        description="weights file of `benchnav train`, or the name of included weights; empty: the"
        " included ones of this name. A suite may list several, one for each training",
    )


class CorrectedConfig(PolicyConfig):
    """Parameters of a policy whose commands are corrected."""

    foresight: bool = Field(True, description="correct twists that would collide")
    hold: float = Field(
        0.9, ge=HELD, le=2, description="[s] longest time for which the prediction holds a twist"
    )


class DriverConfig(CorrectedConfig):
    """The same, for an agent without a path to follow."""

    patience: float = Field(4.0, ge=0, description="[s] of standing before a detour; 0: no detours")


class PolicyPilot(Pilot):
    """The actor with its encoder, and the memory of each agent.

    Deterministic: the mean of the Gaussian over (forward speed, turn rate).

    Args:
        weights: file of `benchnav train`.
        foresight: correct twists that would collide.
        hold: [s] largest duration of a twist.
        patience: [s] of standing before a detour; 0: no detours.
        agents_behind: predict agents behind always; otherwise a policy that perceives them is
            left to avoid them, except in a jam.

    A policy with rays predicts collisions only with what its rays hit; all remember hidden movers.
    A policy that was trained with `hidden_movers` perceives the remembered movers, too.
    """

    def __init__(
        self,
        weights: Path,
        foresight: bool = False,
        hold: float = HELD,
        patience: float = 0.0,
        agents_behind: bool = False,
    ) -> None:
        self._actor, self.about = _loaded(weights)
        self._encoder = encoder(self.about["encoder"])
        self._foresight, self._hold = foresight, hold
        self._rays = Need.RAYS in self._encoder.needs
        self._agents_behind = agents_behind or self._rays
        self._sightings = Sightings(self._rays)
        self._hidden_movers = self.about["hidden_movers"]
        self._detours = Detours(patience) if patience else None
        self._progress = Progress()
        self._kept = RowTable()

    @property
    def needs(self) -> frozenset[Need]:
        around = NEEDS if self._foresight or self._detours else frozenset()
        return self._encoder.needs.union(around)

    @property
    def training(self) -> Training:
        progress = self.about["progress"]
        return Training(int(progress["decisions"]), float(progress["seconds"]))

    @property
    def fingerprint(self) -> str:
        return str(self.about["sha256"])

    def unfit(self, sensing: Sensing) -> str:
        return why_rays_do_not_fit(self._encoder, sensing)

    def reset(self, briefings: Sequence[Briefing], rows: IntArray) -> None:
        for row, briefing in zip(rows, briefings, strict=True):
            memory = np.zeros((len(briefing), self._actor.state_size), np.float32)
            limits = {name: getattr(briefing, name) for name in _LIMITS}
            limits["tolerance"] = np.full(len(briefing), briefing.goal_tolerance)
            self._kept.put(int(row), memory=memory, **limits)
            self._sightings.forget(int(row), len(briefing), briefing.dt)
            self._progress.reset(int(row), briefing)
            if self._detours is not None:
                self._detours.reset(int(row), briefing)

    def tolerance(self, observation: Observation) -> FloatArray:
        return self._limit("tolerance", observation)

    def twists(self, observation: Observation, tolerance: FloatArray) -> FloatArray:
        active, rows = observation.active, observation.rows
        radius, speed, turn = (self._limit(name, observation) for name in _LIMITS)
        bodies = Bodies(radius, speed, turn)
        corrected = self._foresight or self._detours is not None
        recalled = observation
        if corrected or self._hidden_movers:
            recalled = self._sightings.recall(observation)
        perceived = recalled if self._hidden_movers else observation
        encoded = self._encoder.encode(perceived, bodies)
        memory = self._kept.take("memory", rows, active.shape[1]).copy()
        now = memory[active]
        action = np.clip(self._actor.decide(encoded[active], now).astype(float), -1.0, 1.0)
        memory[active] = now
        self._kept.write("memory", rows, memory)
        command = np.zeros((*active.shape, 2))
        command[active] = action
        command[..., 0] = 0.5 * (command[..., 0] + 1.0) * speed
        command[..., 1] *= turn
        if self._detours is not None:
            self._detours.steer(recalled, bodies, command)
        if self._foresight:
            stalled = self._progress.stalled(observation)
            predicted = recalled
            if not self._agents_behind:
                predicted = without_agents_behind(recalled, stalled)
            command = foresee(predicted, bodies, command, tolerance, self._hold)
            dash(predicted, bodies, command, tolerance, self._hold, stalled)
        return command

    def _limit(self, name: str, observation: Observation) -> FloatArray:
        values: FloatArray = self._kept.take(name, observation.rows, observation.active.shape[1])
        return values


def pilot_of(config: PluginConfig, shipped: str, agents_behind: bool = False) -> PolicyPilot:
    """Return the pilot of a `PolicyConfig`; ``shipped`` are the weights if it names none."""
    parameters = config.model_dump()
    weights = _weights_file(parameters.pop("weights") or shipped)
    return PolicyPilot(weights, **parameters, agents_behind=agents_behind)


def _weights_file(name: str) -> Path:
    """Return the included file of this name, or else the path."""
    included = SHIPPED / Path(name).with_suffix(SUFFIX).name
    is_name = Path(name).name == name and Path(name).suffix in ("", SUFFIX)
    return included if is_name and included.is_file() else Path(name)


@lru_cache(maxsize=8)
def _read(path: Path, changed: int) -> tuple[Actor, dict[str, Any]]:
    return read_weights(path)


def _loaded(path: Path) -> tuple[Actor, dict[str, Any]]:
    """Read a file once per state of the file."""
    return _read(path, path.stat().st_mtime_ns if path.is_file() else 0)
