"""Draws docs/images/ablations.png, learning.png and phases.png from stored logs and weights.

    python docs/make_learning_pictures.py

Curves are those in docs/learning/curves, NAME-SEED.csv, as `benchnav train` wrote them;
docs/learning/checkpoints holds an early and a middle checkpoint, the late one ships.
"""

from pathlib import Path

import numpy as np
from benchnav_baselines.learned.recurrent_ppo.learning.log import full_rows, read_rows
from benchnav_baselines.learned.recurrent_ppo.policy_at_work import SHIPPED
from benchnav_baselines.learned.recurrent_ppo.weights import read_weights
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle, Polygon

from benchnav.arena.solid import Kind
from benchnav.arena.world import World
from benchnav.episode.episode import Episode, Status
from benchnav.generation.build import build
from benchnav.runner.rollouts.rollout import Assignment, rollout
from benchnav.scenario.catalogue import find

HERE = Path(__file__).parent
CURVES, CHECKPOINTS = HERE / "learning" / "curves", HERE / "learning" / "checkpoints"
ABLATIONS = {
    "ablation-reference": "reference",
    "ablation-no-lstm": "no LSTM",
    "ablation-no-prediction": "no collision probability",
    "ablation-ego-encoder": "lengths over 8 m (ego)",
    "ablation-paper-encoder": "absolute positions (paper)",
}
COLOURS = ("#1f6feb", "#d1495b", "#2a9d8f", "#8e5aa8", "#e07a3f")
TEAMS = ("#1f6feb", "#d1495b", "#2a9d8f", "#8e5aa8")


def curves(name: str) -> list[list[dict[str, float]]]:
    """The stored curve of every seed."""
    return [read_rows(path) for path in sorted(CURVES.glob(f"{name}-[0-9].csv"))]


def ablations() -> Figure:
    """Reward while training and success on validation worlds; lines are means, bands seeds."""
    figure = Figure(figsize=(10, 4), layout="constrained")
    left, right = figure.subplots(1, 2)
    for (name, label), colour in zip(ABLATIONS.items(), COLOURS, strict=True):
        runs = curves(name)
        for axes, key, shown in (
            (left, "arrived", [full_rows(run) for run in runs]),
            (right, "validation leaders/dynamic", runs),
        ):
            rows = min(map(len, shown))
            x = np.mean([[row["decisions"] for row in run[:rows]] for run in shown], axis=0) / 1e6
            y = 100.0 * np.array([[row[key] for row in run[:rows]] for run in shown])
            axes.plot(x, y.mean(0), color=colour, label=f"{label} ({len(runs)})")
            axes.fill_between(x, y.min(0), y.max(0), color=colour, alpha=0.12, lw=0)
    left.set(title="while training, sampled actions", xlabel="million decisions",
             ylabel="strict success [%]")  # fmt: skip
    right.set(title="validation worlds, deterministic", xlabel="million decisions")
    for axes in (left, right):
        axes.grid(alpha=0.3)
        axes.set_ylim(bottom=0)
    right.legend(fontsize="small", loc="lower right", title="(seeds)")
    return figure


def learning() -> Figure:
    """The whole trainings of what ships."""
    figure = Figure(figsize=(10, 3.6), layout="constrained")
    shipped = ("recurrent-ppo", "recurrent-ppo-plus")
    for axes, navigator in zip(figure.subplots(1, 2, sharey=True), shipped, strict=True):
        about = read_weights(SHIPPED / f"{navigator}.safetensors")[1]
        recipe, seed = about["recipe"], about["progress"]["seed"]
        run = read_rows(CURVES / f"{recipe}-{seed}.csv")
        x = [row["decisions"] / 1e6 for row in run]
        for key in [key for key in run[0] if key.startswith("validation ")]:
            axes.plot(x, [100 * row[key] for row in run], label=key.removeprefix("validation "))
        for k in range(1, len(run) - 1):
            if run[k]["stage"] > run[k - 1]["stage"]:  # the row that ends a stage says the next
                axes.axvline(x[k], color="0.6", ls=":", lw=1)
        axes.set(title=f"recipe {recipe}, seed {seed}", xlabel="million decisions", ylim=(0, 101))
        axes.grid(alpha=0.3)
        axes.legend(fontsize="x-small", loc="lower right")
    figure.axes[0].set_ylabel("strict success on validation worlds [%]")
    return figure


def phases() -> Figure:
    """Figs. 5 and 7: the same worlds, driven by early, middle and late checkpoints."""
    stages = [*sorted(CHECKPOINTS.glob("*.safetensors")), SHIPPED / "recurrent-ppo.safetensors"]
    figure = Figure(figsize=(4 * len(stages), 8.4), layout="constrained")
    grid = figure.subplots(2, len(stages), squeeze=False)
    for row, (scenario, seed) in enumerate((("leaders/static", 3), ("leaders/dynamic", 5))):
        for column, path in enumerate(stages):
            decisions = read_weights(path)[1]["progress"]["decisions"]
            episode = _episode(scenario, seed, path)
            _draw(grid[row, column], episode)
            grid[row, column].set_title(f"{scenario}, {decisions:,} decisions", fontsize=10)
    return figure


def _episode(scenario_name: str, seed: int, weights: Path) -> Episode:
    scenario = find(scenario_name)
    about = Assignment(
        scenario.identity, scenario.hash, "validation", "unknown", "phase",
        {"type": "recurrent-ppo", "weights": str(weights)},
        salt="00",
    )  # fmt: skip
    return next(rollout(about, [(seed, build(scenario, "validation", seed))]))[0]


def _draw(axes: Axes, episode: Episode) -> None:
    world: World = episode.world
    x0, y0, x1, y1 = world.bounds
    for solid in world.solids:
        if solid.kind == Kind.STATIC:
            axes.add_patch(Polygon(solid.loops[0], color="#b3bec7"))
    for m, body in enumerate(world.bodies):
        path = episode.body_position[:, m]
        axes.plot(*path.T, color="#e07a3f", lw=1, ls=":")
        axes.add_patch(Polygon(body.solid.loops[0] + path[-1], color="#e07a3f", alpha=0.8))
    for i in range(len(world.agents)):
        colour = TEAMS[i % len(TEAMS)]
        going = int((episode.status[:, i] == int(Status.ACTIVE)).sum())
        path = episode.position[: going + 1, i]
        axes.plot(*path.T, color=colour, lw=1.6)
        axes.add_patch(Circle(path[0], 0.3, color=colour))
        axes.add_patch(Circle(world.agents.goal[i], 0.5, fill=False, color=colour, lw=2))
        if episode.status[-1, i] == int(Status.ENDED):
            axes.plot(*path[-1], "x", color=colour, ms=11, mew=3)
    axes.set(xlim=(x0, x1), ylim=(y0, y1), aspect="equal", xticks=[], yticks=[])


def main() -> None:
    """Draw all three."""
    for draw in (ablations, learning, phases):
        draw().savefig(HERE / "images" / f"{draw.__name__}.png", dpi=110)


if __name__ == "__main__":
    main()
