"""The script that started Python, for processes that must know the classes that it defines."""

import sys
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, redirect_stdout
from importlib.util import find_spec
from io import StringIO
from pathlib import Path
from types import CodeType, ModuleType
from typing import Any

_MAIN, _IMPORTED = "__main__", "__mp_main__"
_importing: list[bool] = []


class _StopImportError(BaseException):
    """Ends the import of a script at the call that would start the same work again."""


def main_of(places: Iterable[str]) -> dict[str, str]:
    """Return where ``__main__`` comes from, where any of ``places`` is in it; else nothing."""
    return main_module() if is_of_main(places) else {}


def main_module() -> dict[str, str]:
    """Return where ``__main__`` comes from; nothing where it is no file, as in a notebook."""
    main = sys.modules[_MAIN]
    spec, file = getattr(main, "__spec__", None), getattr(main, "__file__", None)
    if spec is not None:
        return {"init_main_from_name": spec.name}
    if file is None or not Path(file).is_file():
        return {}
    return {"init_main_from_path": str(Path(file).absolute())}


def is_of_main(places: Iterable[str]) -> bool:
    """Whether any of ``places``, written module:attribute, is in ``__main__``."""
    return any(place.startswith(f"{_MAIN}:") for place in places)


def import_main(source: dict[str, Any]) -> None:
    """Import the script as ``__mp_main__`` and as ``__main__``; what it prints is dropped.

    The import ends at the first call of `stop_import_of_main`: what the script defines above
    is known.
    """
    module = ModuleType(_IMPORTED)
    code = _code(source, module)
    sys.modules[_MAIN] = sys.modules[_IMPORTED] = module
    _importing.append(True)
    try:
        with redirect_stdout(StringIO()):
            exec(code, module.__dict__)  # noqa: S102 - the script that runs in the parent
    except _StopImportError:
        pass
    finally:
        _importing.clear()


def stop_import_of_main() -> None:
    """End the import where a worker process imports the script that called this."""
    if _importing:
        raise _StopImportError


@contextmanager
def without_main() -> Iterator[None]:
    """Let processes that multiprocessing spawns meanwhile import no script."""
    main = sys.modules[_MAIN]
    sys.modules[_MAIN] = ModuleType(_MAIN)
    try:
        yield
    finally:
        sys.modules[_MAIN] = main


def _code(source: dict[str, Any], module: ModuleType) -> CodeType:
    if "init_main_from_path" in source:
        path = source["init_main_from_path"]
        module.__file__ = path
        compiled: CodeType = compile(Path(path).read_bytes(), path, "exec")
        return compiled
    spec = find_spec(source["init_main_from_name"])
    if spec is None or spec.loader is None:
        raise ImportError(f"There is no module {source['init_main_from_name']!r}.")
    module.__file__, module.__package__ = spec.origin, spec.parent
    found: CodeType = spec.loader.get_code(spec.name)  # type: ignore[attr-defined]
    return found
