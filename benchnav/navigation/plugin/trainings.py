"""Entries with several trainings: one recipe, trained with different random seeds.

The outcome of a training depends on its random seed, so a result of one training says little about
the method (Henderson et al. 2018; Agarwal et al. 2021). A spec may give several files of weights,
``{type: NAME, weights: [a, b, c]}``. Each is run as a navigator of its own with a label such as
``NAME (training 2 of 3)``, and tables show them as one entry NAME.
"""

import re
from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from benchnav.errors import ConfigError
from benchnav.navigation.plugin.configure import Spec

KEYS = ("weights", "file")
"""The parameters that may give several trained files."""
MOST = 99  # trainings of an entry
_LABEL = re.compile(r"(?P<entry>.+) \(training (?P<number>[1-9]\d?) of (?P<count>[1-9]\d?)\)")


@dataclass(frozen=True, order=True)
class Training:
    """The place of a navigator among the trainings of its entry."""

    entry: str  # the name in tables
    number: int  # from 1
    count: int

    @property
    def label(self) -> str:
        """Return the label of the navigator."""
        return f"{self.entry} (training {self.number} of {self.count})"


def training_of(label: str) -> Training | None:
    """Return the training that a label names; None for a navigator that is its own entry."""
    match = _LABEL.fullmatch(label)
    if match is None or int(match["number"]) > int(match["count"]):
        return None
    return Training(match["entry"], int(match["number"]), int(match["count"]))


def entry_of(label: str) -> str:
    """Return the name in tables of the navigator with this label."""
    training = training_of(label)
    return training.entry if training else label


def entries_of(labels: Iterable[str]) -> tuple[str, ...]:
    """Return the entries of some labels, each once, in their order."""
    return tuple(dict.fromkeys(map(entry_of, labels)))


def labels_of_entry(entry: str, labels: Collection[str]) -> tuple[str, ...]:
    """Return the labels of ``labels`` that form an entry: its trainings, or its own."""
    return tuple(label for label in labels if entry in (label, entry_of(label)))


def each_training(spec: Spec, label: str, where: str) -> tuple[Spec, ...]:
    """Return a spec with its label for each training; ``(spec,)`` without a list of files.

    The list may be in a part of the navigator, such as its ``controller``.

    Raises ConfigError for two lists, and for a list with fewer than two files, with more than
    `MOST`, or with a file twice; ``where`` is the place of the spec.
    """
    if isinstance(spec, str):
        return (spec,)
    found = list(_lists(spec))
    if not found:
        return (spec,)
    if len(found) > 1:
        named = " and ".join(".".join(path) for path, _ in found)
        raise ConfigError(f"{where}: Only one parameter can list several trainings. Got {named}.")
    path, files = found[0]
    if not 2 <= len(files) <= MOST or len(set(files)) < len(files):
        raise ConfigError(
            f"{where}: {'.'.join(path)} must be one file, or a list of 2 to {MOST} different files,"
            f" one for each training. Got {files!r}."
        )
    return tuple(
        {**_with(spec, path, file), "label": Training(label, number, len(files)).label}
        for number, file in enumerate(files, 1)
    )


def _lists(spec: Mapping[str, Any], above: tuple[str, ...] = ()) -> Iterator[tuple[Any, Any]]:
    """Yield the (path, files) of every list of texts under one of `KEYS`."""
    for key, value in spec.items():
        path = (*above, key)
        if isinstance(value, Mapping):
            yield from _lists(value, path)
        elif key in KEYS and _is_list_of_texts(value):
            yield path, list(value)


def _is_list_of_texts(value: object) -> bool:
    return isinstance(value, list | tuple) and all(isinstance(text, str) for text in value)


def _with(spec: Mapping[str, Any], path: tuple[str, ...], value: str) -> dict[str, Any]:
    """Return ``spec`` with another value at ``path``."""
    key, *below = path
    return {**spec, key: _with(spec[key], tuple(below), value) if below else value}
