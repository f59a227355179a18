"""Kernels are loaded when they are first called, by Python or by another kernel."""

import pickle
import subprocess
import sys

import numpy as np
import pytest

import benchnav.kernels
from benchnav.kernels import Kernel, inlined, kernel, kernel_without_allocation


@kernel
def double(x):
    return 2.0 * x


@inlined
def one_more(x):
    return x + 1.0


@kernel
def both(x):
    return double(x) + one_more(x)


def test_kernels_call_kernels():
    assert both(3.0) == 10.0
    assert double(3.0) == 6.0
    assert double.py_func(3.0) == 6.0


@kernel_without_allocation
def add_one(values):
    row = values[:]
    for i in range(len(row)):
        row[i] += 1.0


@kernel_without_allocation
def allocating(n):
    return len(np.empty(n))


@pytest.fixture
def code_of(monkeypatch):
    """Compile a kernel, as it is called by Python or by kernels, and return its LLVM code."""
    monkeypatch.setattr(benchnav.kernels, "cache_folder", lambda package: None)

    def compiled(of, argument, by="for_python"):
        dispatcher = getattr(Kernel(of.py_func, **of.targetoptions), by)
        dispatcher(argument) if by == "for_python" else dispatcher.compile((argument,))
        return "".join(dispatcher.inspect_llvm().values())

    return compiled


def test_a_kernel_without_allocation_counts_no_references_and_refuses_to_allocate(code_of):
    from numba.core.errors import NumbaError

    values = np.zeros(2)
    add_one(values)
    assert values.tolist() == [1.0, 1.0]
    assert "NRT_" not in code_of(add_one, values)
    assert "NRT_" in code_of(kernel(add_one.py_func), values)
    with pytest.raises(NumbaError, match="No implementation of function"):
        allocating(2)


def test_what_only_kernels_call_has_no_wrapper_for_python(code_of):
    from numba import float64

    wrapper = "PyArg_UnpackTuple"
    assert wrapper in code_of(double, 3.0)
    assert wrapper not in code_of(double, float64, by="for_kernels")


def test_a_kernel_is_pickled_by_its_name():
    assert pickle.loads(pickle.dumps(double)) is double


def test_tables_and_lists_need_no_numba():
    code = (
        "import sys\n"
        "import benchnav.leaderboard.from_runs, benchnav.runner.run, benchnav.store.runs.reading\n"
        "assert 'numba' not in sys.modules"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr


def test_pandas_waits_until_a_data_frame_is_wanted():
    code = (
        "import sys, pyarrow\n"
        "from benchnav.system.pandas_import import delay_pandas\n"
        "delay_pandas()\n"
        "values = pyarrow.array([1, 2])\n"
        "assert 'pandas' not in sys.modules\n"
        "assert list(values.to_pandas()) == [1, 2]"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr


def test_scipy_waits_until_a_kernel_multiplies_matrices():
    code = (
        "import sys\n"
        "import numpy as np\n"
        "import benchnav.kernels\n"
        "@benchnav.kernels.kernel\n"
        "def product(a, b):\n"
        "    return np.dot(a, b)\n"
        "@benchnav.kernels.kernel\n"
        "def double(x):\n"
        "    return 2 * x\n"
        "assert double(21) == 42\n"
        "assert 'scipy.linalg' not in sys.modules\n"
        "assert product(np.eye(2), np.array([3.0, 4.0])).tolist() == [3.0, 4.0]\n"
        "assert 'scipy.linalg' in sys.modules"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
