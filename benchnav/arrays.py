"""Array type aliases, and the axis letters that every docstring uses.

Axes: B worlds, A agents, R rays, K neighbours, E edges, M bodies (dynamic and
re-placed static obstacles), P primitives (capsules), V vertices, T steps,
W waypoints. A trailing 2 is (x, y).

Units: metres, seconds, radians. Frame: x right, y up, heading counter-clockwise
from +x. Every float array that touches the state is float64.
"""

from typing import Any

import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.int64]
ByteArray = npt.NDArray[np.int8]
CountArray = npt.NDArray[np.unsignedinteger[Any]]
BoolArray = npt.NDArray[np.bool_]
AnyArray = npt.NDArray[Any]
Extent = tuple[float, float, float, float]
"""xmin, ymin, xmax, ymax [m]"""

LARGEST = 1e100  # largest measured value: sums of squares of such values stay finite
