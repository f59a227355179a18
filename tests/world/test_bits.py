"""The same bits for every CPU target, for interpreted kernels, and for any number of threads."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]


def run(steps, **settings):
    """The digest from a fresh interpreter under other settings."""
    answer = subprocess.run(
        [sys.executable, "-m", "tests.world.bits", str(steps)],
        cwd=ROOT, env={**os.environ, **settings}, capture_output=True, text=True, check=True,
    )  # fmt: skip
    return answer.stdout.strip()


@pytest.mark.slow
def test_a_generic_processor_gives_the_same_bits():
    """Other vector units, no fused multiply-add: nothing may be contracted or reordered."""
    assert run(40, NUMBA_CPU_NAME="generic", NUMBA_CPU_FEATURES="") == run(40)


@pytest.mark.slow
def test_interpreted_kernels_give_the_same_bits():
    """Python's floats are IEEE 754 doubles without any optimisation: the plainest twin."""
    assert run(3, NUMBA_DISABLE_JIT="1") == run(3)


@pytest.mark.parametrize("threads", ["1", "3"])
def test_any_number_of_threads_gives_the_same_bits(threads):
    assert run(40, BENCHNAV_THREADS=threads) == run(40)
