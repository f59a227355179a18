"""The runs that a verb reads: folders or packs."""

from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from benchnav.api.records.run import Run


@contextmanager
def opened_runs(paths: Sequence[Path]) -> Iterator["list[Run]"]:
    """Open the runs; packs stay unpacked within the context."""
    from benchnav.api.records.run import open_run
    from benchnav.system.pandas_import import delay_pandas

    delay_pandas()
    with ExitStack() as stack:
        yield [stack.enter_context(open_run(path)) for path in paths]
