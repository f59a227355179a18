"""Figs. 9 and 10: learning curves, with and without LSTM, from the stored logs."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
from benchnav_baselines.learned.recurrent_ppo.learning.log import full_rows, read_rows
from benchnav_baselines.learned.recurrent_ppo.policy_at_work import SHIPPED
from benchnav_baselines.learned.recurrent_ppo.weights import read_weights

from benchnav.arrays import FloatArray

from .markdown import table

CURVES = Path(__file__).parents[2] / "docs" / "learning" / "curves"
WITH, WITHOUT = "ablation-reference", "ablation-no-lstm"
VALIDATION = "validation leaders/dynamic"
EARLY = 1e6  # decisions


def logs(name: str) -> list[list[dict[str, float]]]:
    """The stored log of every seed of a recipe."""
    return [read_rows(path) for path in sorted(CURVES.glob(f"{name}-[0-9].csv"))]


def shipped_log() -> list[dict[str, float]]:
    """Return the stored log of the training whose weights are `recurrent-ppo`."""
    about = read_weights(SHIPPED / "recurrent-ppo.safetensors")[1]
    return read_rows(CURVES / f"{about['recipe']}-{about['progress']['seed']}.csv")


def column(log: list[dict[str, float]], name: str) -> FloatArray:
    """One number of a log over time."""
    return np.array([row[name] for row in log])


def gains() -> list[float]:
    """Return the rise of reward in each third of the first stage, from the first row (Fig. 9)."""
    log = [row for row in shipped_log() if row["stage"] == 0]
    decisions = column(log, "decisions")
    thirds = np.linspace(decisions[0], decisions[-1], 4)
    return [float(gain) for gain in np.diff(np.interp(thirds, decisions, column(log, "reward")))]


def early_success(name: str) -> list[float]:
    """Success on validation worlds at the checkpoint after `EARLY` decisions, by seed."""
    return [
        float(next(row[VALIDATION] for row in log if row["decisions"] >= EARLY))
        for log in logs(name)
    ]


def last_success(name: str) -> list[float]:
    """Success on validation worlds at the end of a recipe's budget, by seed."""
    return [float(log[-1][VALIDATION]) for log in logs(name)]


def budget(name: str) -> float:
    """Return the number of decisions of a recipe."""
    return float(logs(name)[0][-1]["decisions"])


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
        " stage, from its first checkpoint on."
    )
    yield ""
    rows = []
    for name, label in ((WITH, "with LSTM"), (WITHOUT, "without (256 × 256)")):
        runs = logs(name)
        rows.append([
            label, ", ".join(f"{full_rows(log)[-1]['reward']:.2f}" for log in runs),
            ", ".join(f"{100 * x:.1f}" for x in early_success(name)),
            ", ".join(f"{100 * x:.1f}" for x in last_success(name)),
        ])  # fmt: skip
    yield from table(
        ["network", "last reward per attempt, by seed",
         f"success on validation worlds after {EARLY / 1e6:.0f} M decisions %, by seed",
         f"after {budget(WITH) / 1e6:.0f} M"], rows,
    )  # fmt: skip
    yield (
        "![Reward while the shipped navigator learned, and with and without LSTM]"
        "(images/paper-learning.png)"
    )
    yield ""
