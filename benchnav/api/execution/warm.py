"""Compile the kernels ahead of the first run."""

from pathlib import Path
from tempfile import TemporaryDirectory

from benchnav.api.execution.run import run

SUITE = "standard"  # whose navigators use all kernels
SCENARIOS = ("leaders/dynamic", "trap/u")


def compile_kernels(*, quiet: bool = False) -> None:
    """Compile what runs use, and keep it in the cache of the user; takes about a minute, once.

    Every navigator of the suite `standard` runs once in two scenarios; nothing of it is kept.
    """
    with TemporaryDirectory() as folder:
        run(
            SUITE, scenarios=SCENARIOS, tracks="known", seeds=1, out=Path(folder, "run"),
            quiet=quiet,
        )  # fmt: skip
