"""Keep Numba from importing SciPy's linear algebra, which takes 0.2 s, until a kernel needs it."""

import sys
from importlib.util import find_spec


def delay_blas() -> None:
    """Let Numba assume that SciPy has BLAS; it looks again where a kernel calls `numpy.dot`."""
    module = "numba.np.arraymath"
    if module in sys.modules or find_spec("scipy") is None:
        return
    from numba.np import linalg

    look = getattr(linalg, "ensure_blas", None)
    if look is None:  # this Numba looks in another way
        return
    linalg.ensure_blas = lambda: None
    try:
        __import__(module)
    finally:
        linalg.ensure_blas = look
