"""`benchnav pack`: a run as one file for somebody else."""

from pathlib import Path
from typing import Annotated

import typer

from benchnav.cli.console import put, say


def pack(
    run: Annotated[Path, typer.Argument(metavar="RUN", help="Run folder.")],
    out: Annotated[
        Path | None, typer.Option(metavar="FILE", help="The pack. [default: RUN.bnrun]")
    ] = None,
) -> None:
    """Make one file of a run, with everything that is needed to verify it.

    Whoever gets it checks it with `benchnav verify` and needs no navigator for that. Prints
    the file's path.
    """
    from benchnav.errors import UsageError
    from benchnav.store.packs.pack import SUFFIX, content_digest
    from benchnav.store.packs.pack import pack as write_pack
    from benchnav.store.runs.run_folder import RunFolder

    target = out if out is not None else run.with_name(run.resolve().name + SUFFIX)
    if target.suffix != SUFFIX:
        raise UsageError(f"--out must end in {SUFFIX}. Got {target} instead.")
    folder = RunFolder.open(run)
    write_pack(folder, target)
    say(f"{target.stat().st_size / 1e6:.1f} MB, content {content_digest(folder)}")
    put(str(target))
