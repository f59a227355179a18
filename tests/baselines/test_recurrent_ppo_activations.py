import math
from hashlib import sha256

import numpy as np
from benchnav_baselines.learned.recurrent_ppo.activations import exp, tanh

from benchnav.kernels import kernel_without_allocation

DIGEST = "78388e3393c2c94d"  # of expf and tanhf of the GNU C library 2.36


@kernel_without_allocation
def exps(x, out):
    for i in range(len(x)):
        out[i] = exp(x[i])


@kernel_without_allocation
def tanhs(x, out):
    for i in range(len(x)):
        out[i] = tanh(x[i])


def results(x):
    x = np.asarray(x, np.float32)
    both = np.empty((2, len(x)), np.float32)
    exps(x, both[0])
    tanhs(x, both[1])
    return both


def test_they_are_close_to_the_exact_functions():
    x = np.random.default_rng(0).normal(0.0, 4.0, 20_000).astype(np.float32)
    for got, exact, units in zip(
        results(x), (np.exp(x.astype(float)), np.tanh(x.astype(float))), (1.0, 2.0), strict=True
    ):
        unit = np.spacing(np.abs(exact).astype(np.float32)).astype(float)
        assert np.max(np.abs(got - exact) / unit) < units


def test_their_bits_are_those_of_the_c_library_that_weights_were_first_driven_with():
    sizes = np.geomspace(1e-30, 60.0, 40_000)
    assert sha256(results(np.concatenate([sizes, -sizes])).tobytes()).hexdigest()[:16] == DIGEST


def test_they_take_any_number():
    exponential, tangent = results([0.0, -0.0, 200.0, -200.0, math.inf, -math.inf, math.nan])
    np.testing.assert_allclose(exponential, [1, 1, np.inf, 0, np.inf, 0, np.nan], atol=1e-37)
    np.testing.assert_array_equal(tangent, [0, 0, 1, -1, 1, -1, np.nan])
    np.testing.assert_array_equal(np.signbit(tangent[:2]), [False, True])
    np.testing.assert_array_equal(
        results([0.3] * 40 + [0.7])[:, :1], results([0.3])
    )  # the same alone and in a vector
