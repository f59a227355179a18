"""Figs. 9 and 10: learning curves, with and without LSTM, from the stored logs."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
from benchnav_baselines.learned.recurrent_ppo.learning.log import read_rows

from benchnav.arrays import FloatArray

from .markdown import table

CURVES = Path(__file__).parents[2] / "docs" / "learning" / "curves"
WITH, WITHOUT, SHIPPED = "ablation-reference", "ablation-no-lstm", "dynamic"
VALIDATION = "validation leaders/dynamic"


def logs(name: str) -> list[list[dict[str, float]]]:
    """The stored log of every seed of a recipe."""
    return [read_rows(path) for path in sorted(CURVES.glob(f"{name}-[0-9].csv"))]


def column(log: list[dict[str, float]], name: str) -> FloatArray:
    """One number of a log over time."""
    return np.array([row[name] for row in log])


def gains() -> list[float]:
    """Reward per attempt gained in each third of the first stage of what ships (Fig. 9)."""
    log = [row for row in logs(SHIPPED)[0] if row["stage"] == 0]
    reward = column(log, "reward")
    at = reward[np.linspace(0, len(reward) - 1, 4).round().astype(int)]
    return [float(gain) for gain in np.diff(at)]


def last_success(name: str) -> list[float]:
    """Success on validation worlds at the end of a recipe's budget, by seed."""
    return [float(log[-1][VALIDATION]) for log in logs(name)]


def section() -> Iterator[str]:
    """Lines of the page."""
    yield "## Figs. 9 and 10: learning, with and without LSTM"
    yield ""
    first = gains()
    yield (
        "From the logs in `docs/learning/curves`, which `benchnav train` wrote"
        " ([more of them](learning.md)). While `recurrent-ppo` learned, its reward per attempt"
        " rose by"
        f" {first[0]:.2f}, {first[1]:.2f} and {first[2]:.2f} in the three thirds of the first"
        " stage."
    )
    yield ""
    rows = []
    for name, label in ((WITH, "with LSTM"), (WITHOUT, "without (256 × 256)")):
        runs = logs(name)
        rows.append([
            label, ", ".join(f"{log[-1]['reward']:.2f}" for log in runs),
            ", ".join(f"{100 * x:.1f}" for x in last_success(name)),
            f"{runs[0][-1]['decisions']:,.0f}",
            f"{np.mean([log[-1]['seconds'] for log in runs]):.0f}",
        ])  # fmt: skip
    yield from table(
        ["network", "last reward per attempt, by seed", "success on validation worlds %, by seed",
         "decisions", "seconds"], rows,
    )  # fmt: skip
    yield (
        "![Reward while the shipped navigator learned, and with and without LSTM]"
        "(images/paper-learning.png)"
    )
    yield ""
