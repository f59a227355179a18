"""The declarations of metrics: unit, direction, range. Plugins declare in their own process."""

from typing import Annotated, Any, Literal, NoReturn

from pydantic import AfterValidator, BaseModel, ConfigDict, StrictBool, ValidationError

from benchnav.config.model_errors import first_problem
from benchnav.errors import BenchnavError, PluginError
from benchnav.metrics.measure import is_own, load_metric
from benchnav.metrics.metric import Metric
from benchnav.navigation.command_check import short
from benchnav.navigation.plugin.plugin_process import (
    IMPORT,
    Plugin,
    StepCallback,
    query_plugins,
    serve,
)
from benchnav.plugins import METRICS
from benchnav.processes.channel import Channel

_TIMEOUT = 30.0  # [s] for an import
_Line = Annotated[str, AfterValidator(short)]


class _Declaration(BaseModel):
    """A metric without its name and its function."""

    model_config = ConfigDict(extra="forbid", from_attributes=True)

    title: _Line
    unit: _Line
    better: Literal["higher", "lower"] | None
    low: float
    high: float
    reference: _Line
    scope: Literal["agent", "group"]
    conditional: StrictBool
    verifiable: StrictBool
    rate: StrictBool
    people: StrictBool = False
    undisturbed: StrictBool = False


def declared_metrics() -> tuple[dict[str, Metric], list[str]]:
    """Return (metrics by name, reasons why others cannot be used).

    A metric of a plugin has no function here; `benchnav.runner.execute.remeasurement` measures
    with it.
    """
    found: dict[str, Metric | BenchnavError] = {}
    groups: dict[str, list[Plugin]] = {}
    for name in METRICS.names():
        try:
            if METRICS.is_local(name) or is_own(name):
                found[name] = load_metric(name)
            else:
                source = METRICS.source(name).distribution
                groups.setdefault(source, []).append(Plugin(METRICS.kind, name, "", name))
        except PluginError as error:
            found[name] = error
    answers = query_plugins(f"{__name__}:serve_declarations", list(groups.values()), _TIMEOUT)
    for group, answered in zip(groups.values(), answers, strict=True):
        for plugin, answer in zip(group, answered, strict=True):
            found[plugin.name] = _metric(plugin, answer)
    metrics = {name: found[name] for name in METRICS.names()}
    return (
        {name: metric for name, metric in metrics.items() if isinstance(metric, Metric)},
        [str(error) for error in metrics.values() if isinstance(error, BenchnavError)],
    )


def _metric(plugin: Plugin, answer: Any) -> Metric | BenchnavError:
    if isinstance(answer, BenchnavError):
        return answer
    try:
        declared = _Declaration.model_validate(answer)
    except ValidationError as error:
        problem = first_problem(error)
        key = problem.key or "declaration"
        return plugin.broken(f"its {key} {problem.requirement}; got {problem.got}")
    return Metric(name=plugin.name, function=_not_here, **declared.model_dump())


def _not_here(*_: Any) -> NoReturn:
    raise PluginError("A metric of a plugin is measured in a separate process.")


def serve_declarations(channel: Channel, notes: "memoryview[float]") -> None:
    """Send the declarations of the requested metrics. Runs in a separate process."""
    serve(channel, notes, _declared)


def _declared(name: str, on_step: StepCallback) -> dict[str, Any]:
    on_step(IMPORT)
    return _Declaration.model_validate(load_metric(name)).model_dump()
