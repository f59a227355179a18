"""Termination conditions of a search."""

import math
from collections.abc import Callable
from time import perf_counter


class Budget:
    """A termination condition that counts its calls, so that a search is reproducible.

    It stops after ``iterations`` calls, or ``improve`` calls after ``best_cost``
    first was finite, or, if ``seconds`` are given, when they have passed.
    """

    def __init__(self, iterations: int, improve: int = 0, seconds: float | None = None) -> None:
        self.best_cost: Callable[[], float] | None = None
        self._left = iterations
        self._improve = improve
        self._deadline = math.inf if seconds is None else perf_counter() + seconds
        self._solved = False

    def __call__(self) -> bool:
        self._left -= 1
        if not self._solved and self.best_cost is not None and self.best_cost() < math.inf:
            self._solved = True
            self._left = min(self._left, self._improve)
        return self._left < 0 or (self._deadline < math.inf and perf_counter() > self._deadline)
