"""The text that shows what a worker does now, for long episodes."""

from benchnav.runner.execute.call_timer import CallTimer
from benchnav.runner.plan.task import Task


def activity(task: Task, timer: CallTimer, measuring: bool) -> str:
    """Return a text like ``orca in big/map, seed 0: 340 of 4,000 decisions``.

    It is "" while the worker starts. ``measuring``: whether the episodes of the task are measured.
    """
    scenario, seeds = task.job.scenario, task.seeds
    which = f"seed {task.first}" if len(seeds) == 1 else f"seeds {task.first} to {task.stop - 1}"
    played = f"{task.job.contestant.label} in {scenario.name}, {which}"
    if measuring:
        return f"measuring {played}"
    if timer.drawing in range(1, len(seeds) + 1):
        return f"drawing the world of seed {seeds[int(timer.drawing) - 1]} of {scenario.name}"
    if not timer.called:
        return ""
    time, clock = timer.episode_time, scenario.clock
    if time is None:
        return f"{'storing' if timer.has_played else 'preparing'} {played}"
    decisions = round(min(time / clock.dt, float(clock.steps)))
    return f"{played}: {decisions:,} of {clock.steps:,} decisions"
