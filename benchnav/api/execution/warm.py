"""Compile the kernels ahead of the first run."""

from pathlib import Path
from tempfile import TemporaryDirectory

SUITE = "standard"  # whose navigators use all kernels
SCENARIOS = ("leaders/dynamic", "trap/u", "robots/plaza")  # discs, and bodies of robots
PERCEPTIONS = ("exact", "noisy")


def compile_kernels(*, quiet: bool = False) -> None:
    """Compile what runs use, and keep it in the cache of the user; takes about a minute, once.

    Every navigator of the suite `standard` runs once in three scenarios with each perception;
    nothing of it is kept.
    """
    from benchnav.runner.execute.progress import progress
    from benchnav.runner.plan.suite import Selection, load_suite
    from benchnav.runner.run import run_suite

    chosen = Selection(scenarios=SCENARIOS, tracks=("known",), seeds="1", perceptions=PERCEPTIONS)
    suite = load_suite(SUITE, chosen)
    with TemporaryDirectory() as folder:
        run_suite(suite, Path(folder, "run"), progress=progress(quiet))
