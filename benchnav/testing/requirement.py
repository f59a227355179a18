"""Helpers of the checks: requirements with messages, and factories of the checked objects."""

import random
import sys
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from typing import Any

import numpy as np
from pydantic import BaseModel, ValidationError

from benchnav.arrays import FloatArray
from benchnav.navigation.plugin.configure import make
from benchnav.plugins import Registry

Subject = str | Mapping[str, Any] | Callable[[], Any]
ROUNDING = 1e-6  # [m/s, rad/s, m]: the order of a sum may differ, nothing else


def require(condition: object, message: str) -> None:
    """Raise AssertionError with ``message`` unless the condition holds."""
    if not condition:
        raise AssertionError(message)


def maker(registry: Registry, subject: Subject) -> Callable[[], Any]:
    """Return a factory for a name, a ``{type: …}`` mapping, a class or a function."""
    if isinstance(subject, str | Mapping):
        return lambda: make(registry, subject)
    return subject


def require_config(thing: Any) -> None:
    """Check that the Config is frozen, refuses unknown keys, and describes each parameter."""
    name, declared = type(thing).__name__, getattr(thing, "Config", None)
    is_model = isinstance(declared, type) and issubclass(declared, BaseModel)
    require(is_model, f"{name}.Config must be a pydantic model. Got {declared!r} instead.")
    config: Any = declared
    require(
        config.model_config.get("frozen") and config.model_config.get("extra") == "forbid",
        f"{name}.Config must be frozen and forbid unknown keys: derive it from PluginConfig.",
    )
    for key, field in config.model_fields.items():
        require(field.description, f"{name}.Config.{key} must have a description with its unit.")
    try:
        config(**{"no such parameter": 1})
    except ValidationError:
        return
    raise AssertionError(f"{name}.Config must refuse a parameter that it does not have.")


def require_same(
    expected: list[FloatArray], got: list[FloatArray], name: str, circumstance: str
) -> None:
    """Check that two lists of arrays are equal up to rounding, with NaN equal to NaN."""
    for k, (one, other) in enumerate(zip(expected, got, strict=True)):
        same = one.shape == other.shape and np.allclose(
            one, other, rtol=ROUNDING, atol=ROUNDING, equal_nan=True
        )
        if not same:
            at = tuple(np.argwhere(~np.isclose(one, other, ROUNDING, ROUNDING, equal_nan=True))[0])
            raise AssertionError(
                f"{name} must answer the same {circumstance}."
                f" Got {_point(other, at)} in place of {_point(one, at)} for agent {at[1]}"
                f" of world {k} at decision {at[0]}."
            )


def _point(array: FloatArray, at: tuple[int, ...]) -> str:
    return "(" + ", ".join(f"{value:.6g}" for value in array[at[:2]]) + ")"


@contextmanager
def global_generators_untouched(name: str) -> Iterator[None]:
    """Check that the block does not use the generators of random, numpy and torch."""
    before = _generator_states()
    yield
    for module, state in _generator_states().items():
        require(
            before.get(module, state) == state,
            f"{name} must draw from its briefing's generator only. It used {module}'s global one.",
        )


def _generator_states() -> dict[str, object]:
    legacy = np.random.get_state(legacy=False)  # noqa: NPY002  it is read, not drawn from
    states: dict[str, object] = {"random": random.getstate(), "numpy.random": repr(legacy)}
    torch = sys.modules.get("torch")
    if torch is not None:
        states["torch"] = bytes(torch.get_rng_state().numpy())
    return states
