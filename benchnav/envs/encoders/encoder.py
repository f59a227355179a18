"""The contract of an encoder: a fixed list of described numbers per agent."""

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
    meaning: str


@dataclass(frozen=True, eq=False)
class Bodies:
    """(B, A) properties of the encoded agents; padding may have any positive number."""

    radius: FloatArray  # [m]
    max_speed: FloatArray  # [m/s]
    max_turn_rate: FloatArray  # [rad/s]


class Encoder(ABC):
    """Observation → (B, A, D) float32: a pure function of the observation of one decision."""

    name: ClassVar[str]
    needs: ClassVar[frozenset[Need]]

    @property
    @abstractmethod
    def numbers(self) -> tuple[Number, ...]:
        """(D,) the descriptions of the numbers, in order."""

    @property
    def size(self) -> int:
        """D."""
        return len(self.numbers)

    @abstractmethod
    def encode(self, seen: Observation, bodies: Bodies) -> Float32Array:
        """Return (B, A, D), each number within its range; inactive agents may have any."""


def within(numbers: tuple[Number, ...], values: FloatArray) -> Float32Array:
    """Return ``values`` (…, D) clipped to the ranges of ``numbers``."""
    low = np.array([n.low for n in numbers])
    high = np.array([n.high for n in numbers])
    clipped: Float32Array = np.clip(values, low, high).astype(np.float32)
    return clipped


def rays_of(seen: Observation, count: int, name: str) -> Rays:
    """Return the rays. Raises UsageError if their number is not ``count``."""
    if seen.rays is None or len(seen.rays.angle) != count:
        got = "none" if seen.rays is None else str(len(seen.rays.angle))
        raise UsageError(
            f"The encoder {name!r} was made for {count} rays an agent. Got {got} instead."
        )
    return seen.rays
