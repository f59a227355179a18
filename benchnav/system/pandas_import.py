"""Keep pyarrow from importing pandas, which takes half a second, until a data frame is wanted."""

import sys
from importlib.machinery import ModuleSpec


class _NoPandas:
    def find_spec(self, name: str, *_: object) -> ModuleSpec | None:
        if name == "pandas":
            raise ModuleNotFoundError(name)
        return None


def delay_pandas() -> None:
    """Let the first `pyarrow.array` look for pandas in vain; `to_pandas` looks again.

    For processes of benchnav itself, which give pyarrow no series and no value of pandas: pyarrow
    would not recognise a `pandas.NA` afterwards.
    """
    if "pandas" in sys.modules:
        return
    import pyarrow as pa

    hidden = _NoPandas()
    sys.meta_path.insert(0, hidden)
    try:
        pa.array([0])
    finally:
        sys.meta_path.remove(hidden)
