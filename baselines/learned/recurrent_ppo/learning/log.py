"""The learning curve: a CSV that grows, TensorBoard events, and a picture."""

import csv
from collections.abc import Mapping
from pathlib import Path
from statistics import median
from typing import Any

CURVE = "curve.csv"


class Curve:
    """Rows of numbers by decisions; a resumed training drops the rows after its checkpoint."""

    def __init__(self, folder: Path, decisions: int) -> None:
        self._path = folder / CURVE
        self._folder = folder
        self.rows = [row for row in read_curve(folder) if row["decisions"] <= decisions]
        self._write_all()
        self._events: Any = None

    def add(self, row: Mapping[str, float]) -> None:
        """Append a row, on disk and for TensorBoard."""
        self.rows.append(dict(row))
        if len(self.rows) == 1:
            self._write_all()
        else:
            with self._path.open("a", newline="") as file:
                csv.DictWriter(file, list(self.rows[0])).writerow(row)
        if self._events is None:
            from torch.utils.tensorboard import SummaryWriter

            self._events = SummaryWriter(str(self._folder / "tensorboard"))
        for name, value in row.items():
            if name != "decisions":
                self._events.add_scalar(name, value, int(row["decisions"]))

    def close(self) -> None:
        """Flush, and draw the picture."""
        if self._events is not None:
            self._events.close()
        draw_curve(self.rows, self._folder / "curve.png")

    def _write_all(self) -> None:
        part = self._path.with_suffix(".part")
        with part.open("w", newline="") as file:
            if self.rows:
                writer = csv.DictWriter(file, list(self.rows[0]))
                writer.writeheader()
                writer.writerows(self.rows)
        part.replace(self._path)


def read_curve(folder: Path) -> list[dict[str, float]]:
    """Return the stored curve of a training; empty if there is none."""
    path = folder / CURVE
    return read_rows(path) if path.exists() else []


def read_rows(path: Path) -> list[dict[str, float]]:
    """Return every complete row of a curve's file."""
    with path.open(encoding="utf-8", newline="") as file:
        rows = csv.DictReader(file)
        return [
            {name: float(value) for name, value in row.items()}
            for row in rows
            if all(value not in (None, "") for value in row.values())
        ]


def full_rows(rows: list[dict[str, float]]) -> list[dict[str, float]]:
    """Return the rows that are means over enough attempts; the last may have few."""
    least = 0.5 * median(row["attempts"] for row in rows)
    return [row for row in rows if row["attempts"] >= least]


def draw_curve(rows: list[dict[str, float]], path: Path) -> None:
    """Draw reward and success against decisions; do nothing if matplotlib is not installed."""
    try:
        from matplotlib.figure import Figure
    except ImportError:
        return
    if not rows:
        return
    figure = Figure(figsize=(9, 3.5), layout="constrained")
    left, right = figure.subplots(1, 2)
    x = [row["decisions"] / 1e6 for row in rows]
    left.plot(x, [row["reward"] for row in rows])
    left.set(xlabel="million decisions", ylabel="reward of an attempt")
    right.plot(x, [100 * row["arrived"] for row in rows], label="while training", alpha=0.6)
    for name in [n for n in rows[0] if n.startswith("validation ")]:
        right.plot(x, [100 * row[name] for row in rows], label=name.removeprefix("validation "))
    right.set(xlabel="million decisions", ylabel="strict success [%]", ylim=(0, 101))
    right.legend(fontsize="small")
    for axes in (left, right):
        axes.grid(alpha=0.3)
    figure.savefig(path, dpi=130)
