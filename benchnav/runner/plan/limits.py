"""The limits of a navigator, beyond which its worker is stopped."""

import math
from collections.abc import Mapping
from dataclasses import dataclass

LONGEST = 1e6  # [s]
LARGEST = 1e6  # [GB]


@dataclass(frozen=True)
class Limits:
    """An episode fails if it exceeds them. They affect results, so the manifest stores them.

    Raises ValueError if a limit is not positive and finite.
    """

    timeout: float = 300.0  # [s] of wall clock that one call of a navigator may last
    memory: float = 4.0  # [GB] that a worker and its child processes may hold in RAM

    def __post_init__(self) -> None:
        for name, most in (("timeout", LONGEST), ("memory", LARGEST)):
            value = getattr(self, name)
            if not (math.isfinite(value) and 0.0 < value <= most):
                raise ValueError(f"{name} must be above 0 and at most {most:g}; got {value:g}")

    def fields(self) -> dict[str, float]:
        """Return the fields of the manifest."""
        return {"timeout_seconds": self.timeout, "memory_gigabytes": self.memory}

    @classmethod
    def of(cls, fields: Mapping[str, float]) -> "Limits":
        """Return the limits in a manifest; older runs have none, and get the defaults."""
        usual = cls()
        return cls(
            fields.get("timeout_seconds", usual.timeout),
            fields.get("memory_gigabytes", usual.memory),
        )

    def __str__(self) -> str:
        return f"{self.timeout:g} s a call and {self.memory:g} GB a worker"


def patience(timeout: float | None) -> float:
    """Return the time limit [s] for a navigator that reports its properties."""
    try:
        return Limits().timeout if timeout is None else Limits(timeout=timeout).timeout
    except ValueError:
        return Limits().timeout
