"""What a navigator may take before its worker is stopped."""

import math
from collections.abc import Mapping
from dataclasses import dataclass

LONGEST = 1e6  # [s]
LARGEST = 1e6  # [GB]


@dataclass(frozen=True)
class Limits:
    """Beyond them an episode fails: they have a say in results, and stand in the manifest.

    Raises ValueError where a limit is not positive and finite.
    """

    timeout: float = 300.0  # [s] of wall clock that one call of a navigator may last
    memory: float = 4.0  # [GB] that a worker and what it started may hold in RAM

    def __post_init__(self) -> None:
        for name, most in (("timeout", LONGEST), ("memory", LARGEST)):
            value = getattr(self, name)
            if not (math.isfinite(value) and 0.0 < value <= most):
                raise ValueError(f"{name} must be above 0 and at most {most:g}; got {value:g}")

    def said(self) -> dict[str, float]:
        """For the manifest."""
        return {"timeout_seconds": self.timeout, "memory_gigabytes": self.memory}

    @classmethod
    def of(cls, said: Mapping[str, float]) -> "Limits":
        """What a manifest says; runs of before there were limits say nothing."""
        usual = cls()
        return cls(
            said.get("timeout_seconds", usual.timeout), said.get("memory_gigabytes", usual.memory)
        )

    def __str__(self) -> str:
        return f"{self.timeout:g} s a call and {self.memory:g} GB a worker"


def patience(timeout: float | None) -> float:
    """[s] for a call of a navigator that is asked who it is, before the limits are checked."""
    try:
        return Limits().timeout if timeout is None else Limits(timeout=timeout).timeout
    except ValueError:
        return Limits().timeout
