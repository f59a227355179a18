"""The main script of this Python, for processes that need its definitions."""

import sys
from multiprocessing import spawn
from pathlib import Path
from typing import Any

from benchnav.errors import BenchnavError

_importing: list[bool] = []


def main_module() -> dict[str, str]:
    """Return where ``__main__`` comes from; empty if it is not a file, as in a notebook."""
    main = sys.modules["__main__"]
    spec, file = getattr(main, "__spec__", None), getattr(main, "__file__", None)
    if spec is not None:
        return {"init_main_from_name": spec.name}
    if file is None or not Path(file).is_file():
        return {}
    return {"init_main_from_path": str(Path(file).absolute())}


def import_main(origin: dict[str, Any]) -> None:
    """Import the script as ``__mp_main__`` and ``__main__``, as multiprocessing does."""
    _importing.append(True)
    spawn.prepare(origin)
    _importing.clear()


def require_main_guard() -> None:
    """Raise BenchnavError if this process is importing the script that would start it again."""
    if _importing:
        raise BenchnavError(
            "Worker processes must be able to import the script that starts them. A script must"
            " call this under `if __name__ == '__main__':`; 0 workers need none."
        )
