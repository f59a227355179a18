"""The labels of navigators for which the user gave none."""

import json
from collections.abc import Mapping, Sequence
from typing import Any

from benchnav.navigation.plugin.configure import Spec
from benchnav.runner.plan.contestant import label_of

LONGEST = 60  # characters of a label that lists parameters


def labelled(specs: Sequence[Spec]) -> tuple[Spec, ...]:
    """Return the specs with a label for each that shares its name with another.

    The label lists the parameters that differ, as in ``orca(time_horizon=3)``, or is a number, as
    in ``orca#2``, if the list would be long. Labels of the user and names that occur once do not
    change. Equal specs get the same label.
    """
    found = list(specs)
    for name in dict.fromkeys(map(label_of, specs)):
        group = [k for k, spec in enumerate(specs) if _is_free(spec) and label_of(spec) == name]
        distinct = list(dict.fromkeys(_written(specs[k]) for k in group))
        if len(distinct) < 2:
            continue
        labels = _labels(name, [specs[k] for k in group])
        for k, label in zip(group, labels, strict=True):
            found[k] = _with_label(specs[k], label)
    return tuple(found)


def _is_free(spec: Spec) -> bool:
    """Whether the user gave no label."""
    return isinstance(spec, str) or (isinstance(spec, Mapping) and "label" not in spec)


def _parameters(spec: Spec) -> dict[str, Any]:
    return {} if isinstance(spec, str) else {k: v for k, v in spec.items() if k != "type"}


def _written(spec: Spec) -> str:
    return _text(_parameters(spec))


def _text(value: Any) -> str:
    return value if isinstance(value, str) else json.dumps(value, default=repr, sort_keys=True)


def _labels(name: str, group: Sequence[Spec]) -> list[str]:
    every = [_parameters(spec) for spec in group]
    shared = {
        key for key in every[0]
        if all(key in own and _text(own[key]) == _text(every[0][key]) for own in every)
    }  # fmt: skip
    labels, numbers = [], dict[str, int]()
    for own, spec in zip(every, group, strict=True):
        number = numbers.setdefault(_written(spec), len(numbers) + 1)
        text = ", ".join(f"{key}={_text(v)}" for key, v in sorted(own.items()) if key not in shared)
        label = f"{name}({text})" if text else name
        labels.append(label if len(label) <= LONGEST else f"{name}#{number}")
    return labels


def _with_label(spec: Spec, label: str) -> Spec:
    if isinstance(spec, str):
        return spec if spec == label else {"type": spec, "label": label}
    return {**spec, "label": label}
