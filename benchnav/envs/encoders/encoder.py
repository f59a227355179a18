"""What every encoder is: a fixed list of described numbers per agent."""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
import numpy.typing as npt

from benchnav.arrays import FloatArray
from benchnav.errors import UsageError
from benchnav.navigation.navigator import Need
from benchnav.navigation.observation import Observation
from benchnav.sensors.readings import Rays

Float32Array = npt.NDArray[np.float32]


@dataclass(frozen=True)
class Number:
    """One number of an encoding."""

    name: str
    unit: str  # before scaling: "m", "m/s", "rad", or "" for a flag
    low: float  # after scaling
    high: float
    says: str


@dataclass(frozen=True, eq=False)
class Bodies:
    """(B, A) of the agents that are encoded; padding may hold any positive number."""

    radius: FloatArray  # [m]
    max_speed: FloatArray  # [m/s]
    max_turn_rate: FloatArray  # [rad/s]


class Encoder(ABC):
    """Observation → (B, A, D) float32. A pure function of one decision's view."""

    name: ClassVar[str]
    needs: ClassVar[frozenset[Need]]

    @property
    @abstractmethod
    def numbers(self) -> tuple[Number, ...]:
        """(D,) what each number is, in order."""

    @property
    def size(self) -> int:
        """D."""
        return len(self.numbers)

    @abstractmethod
    def encode(self, seen: Observation, bodies: Bodies) -> Float32Array:
        """(B, A, D), every number within its range; inactive agents hold anything finite."""


def within(numbers: tuple[Number, ...], values: FloatArray) -> Float32Array:
    """``values`` (…, D) clipped to the ranges of ``numbers``."""
    low = np.array([n.low for n in numbers])
    high = np.array([n.high for n in numbers])
    clipped: Float32Array = np.clip(values, low, high).astype(np.float32)
    return clipped


def ahead_aside(heading: FloatArray, vector: FloatArray) -> FloatArray:
    """``vector`` (…, 2) in the frame of ``heading`` (…): x ahead, y to the left."""
    c, s = np.cos(heading), np.sin(heading)
    x, y = vector[..., 0], vector[..., 1]
    return np.stack([c * x + s * y, c * y - s * x], axis=-1)


def rays_of(seen: Observation, count: int, name: str) -> Rays:
    """The rays, of which there must be ``count``."""
    if seen.rays is None or len(seen.rays.angle) != count:
        got = "none" if seen.rays is None else str(len(seen.rays.angle))
        raise UsageError(
            f"The encoder {name!r} was made for {count} rays an agent. Got {got} instead."
        )
    return seen.rays
