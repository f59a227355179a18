"""Differences between a run and the installed scenarios, navigators and suites of the same names.

Verification does not cover this: a run of an easy world under the name of a hard one can be
verified, and a caveat is then shown beside its numbers.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from benchnav.config.yaml_reader import read_yaml, validate
from benchnav.errors import BenchnavError, UnknownPluginError
from benchnav.navigation.hierarchy.composition import HIERARCHICAL, is_pair, parameters_of
from benchnav.navigation.plugin.trainings import each_training
from benchnav.plugins import NAVIGATORS
from benchnav.runner.plan.contestant import label_of
from benchnav.runner.plan.limits import Limits
from benchnav.runner.plan.suite_file import SuiteFile, parse_seeds, suite_names, suite_path
from benchnav.scenario.catalogue import find
from benchnav.scenario.catalogue import names as scenario_names
from benchnav.scenario.condition import perceptions_of
from benchnav.store.runs.manifest import Manifest
from benchnav.text.plural import counted
from benchnav.text.visible import shortened

_SHOWN = 3  # names of each kind
_LONG = 80  # characters of a name


@dataclass(frozen=True, order=True)
class Caveat:
    """A sentence, and the records that it applies to."""

    text: str
    scenario: str = ""  # identity; "" for every scenario
    navigator: str = ""  # label; "" for every navigator


def caveats_of(manifest: Manifest) -> list[Caveat]:
    """Return the differences between the suite of a run and the installed one of that name."""
    suite = manifest.suite
    found: list[Caveat] = []
    for entry in suite.get("scenarios", ()):
        found += _of_scenario(str(entry["scenario"]), str(entry.get("hash", "")))
    for entry in suite.get("navigators", ()):
        found += _of_navigator(entry)
    for label in manifest.unguarded:
        found.append(
            Caveat(
                f"{_short(label)} ran unguarded, in the runner's own process: it is never marked"
                " as verified.",
                navigator=label,
            )
        )
    return [*found, *_of_suite(manifest)]


def _of_scenario(identity: str, found: str) -> Iterator[Caveat]:
    if _bare(identity) not in scenario_names():
        return
    try:
        here = find(identity).hash
    except UnknownPluginError as error:
        yield Caveat(f"{_short(identity)} cannot be compared: {error}", identity)
        return
    except BenchnavError:
        yield Caveat(
            f"{_short(identity)} cannot be compared: the scenario of this name that is installed"
            " here cannot be loaded with these parameters.",
            identity,
        )
        return
    if here != found:
        yield Caveat(
            f"{_short(identity)} is another scenario than the one of this name that is installed"
            f" here: its hash is {_short(found)[:12]}, not {here[:12]}.",
            identity,
        )


def _of_navigator(entry: Mapping[str, Any]) -> Iterator[Caveat]:
    label, kind = str(entry["label"]), str(entry["config"].get("type"))
    if label in NAVIGATORS.names() and kind != label:
        yield Caveat(
            f"The label {_short(label)} stands for the navigator {_short(kind)}, not for the one of"
            " this name that is installed here.",
            navigator=label,
        )
    elif kind in NAVIGATORS.names():
        theirs = str(entry.get("source", "")).partition(",")[0].split(" ")[0]
        here = NAVIGATORS.source(kind).distribution.split(" ")[0]
        if theirs != here:
            yield Caveat(
                f"{_short(label)} is the navigator {_short(kind)} of {_short(theirs)}; the one of"
                f" this name that is installed here is of {here}.",
                navigator=label,
            )


def _of_suite(manifest: Manifest) -> Iterator[Caveat]:
    """Yield one caveat if a run has the name of an installed suite but differs from it."""
    name = str(manifest.suite.get("name"))
    if name not in suite_names():
        return
    here = validate(SuiteFile, read_yaml(suite_path(name)))
    differing = [*_numbers(manifest, here), *_members(manifest, here)]
    if differing:
        version = manifest.suite.get("version")
        yield Caveat(
            f"{name}@{version} is not run as it is installed here: {'; '.join(differing)}."
        )


def _numbers(manifest: Manifest, here: SuiteFile) -> Iterator[str]:
    suite, seeds = manifest.suite, parse_seeds(str(here.seeds))
    first, stop = suite["seeds"]
    usual, limits = Limits(), Limits.of(manifest.limits)
    for what, run, installed in (
        ("version", suite.get("version"), here.version),
        ("split", suite.get("split"), here.split),
        ("seeds", f"{first}:{stop}", f"{seeds.start}:{seeds.stop}"),
        ("limits", str(limits), str(usual)),
    ):
        if run != installed:
            yield f"{what} {run}, not {installed}"


def _members(manifest: Manifest, here: SuiteFile) -> Iterator[str]:
    """Yield scenarios, tracks, perceptions and navigators that are missing, added or changed."""
    suite = manifest.suite
    own = {
        label_of(training): training
        for spec in here.navigators
        for training in each_training(spec, label_of(spec), here.name)
    }
    entries = {str(e["label"]): e["config"] for e in suite.get("navigators", ())}
    changed = {label for label in own if label in entries and not _fits(own[label], entries[label])}
    for what, run, installed in (
        ("scenario", {_named(e["scenario"]) for e in suite["scenarios"]},
         {_named(name) for name in here.scenarios}),
        ("track", set(map(str, suite.get("tracks", ()))), set(here.tracks)),
        ("perception", set(perceptions_of(suite)), set(here.perception)),
        ("navigator", set(entries) - changed, set(own)),
    ):  # fmt: skip
        kept, others = run & installed, sorted(run - installed)
        if len(kept) < len(installed):
            yield f"{len(kept)} of its {counted(len(installed), what)}"
        if others:
            more = ", …" if len(others) > _SHOWN else ""
            listed = ", ".join(map(_short, others[:_SHOWN])) + more
            yield f"{counted(len(others), what)} that it does not have ({listed})"
    if changed:
        listed = ", ".join(sorted(changed))
        yield f"{counted(len(changed), 'navigator')} with other parameters ({listed})"
    if bool(here.blocks) != bool(suite.get("blocks")):
        yield "other combinations of them"


def _fits(spec: Any, config: Mapping[str, Any]) -> bool:
    """Whether a navigator has the parameters in the suite file; defaults are not compared."""
    if spec is True:  # a part with the defaults
        return True
    given = {"type": spec} if isinstance(spec, str) else dict(spec)
    given.pop("label", None)
    if is_pair(str(given.get("type", ""))):
        given = {"type": HIERARCHICAL, **parameters_of(given.pop("type"), given)}
    return all(
        _fits(value, config[key])
        if isinstance(config.get(key), Mapping)
        else config.get(key) == value
        for key, value in given.items()
    )


def _bare(identity: str) -> str:
    return identity.partition(":")[0].partition("@")[0]


def _named(name: str) -> str:
    """Return the name of a scenario without its version, with its parameters."""
    base, _, parameters = name.partition(":")
    return base.partition("@")[0] + (f":{parameters}" if parameters else "")


def _short(text: str) -> str:
    return shortened(text, _LONG)
