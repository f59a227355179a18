"""The contract of a metric, which the registry checks."""

from types import ModuleType
from typing import Any

from benchnav.metrics.metric import Metric


def metric_rule(name: str, plugin: Any) -> str:
    """Return the requirement that the metric ``name`` violates, as a verb phrase; "" if none."""
    if isinstance(plugin, ModuleType):
        return f"be named as one metric, {plugin.__name__}:{name}: a module is no metric"
    if not isinstance(plugin, Metric):
        return "be a benchnav.metrics.metric.Metric, as the decorator `metric` makes of a function"
    if ":" not in name and plugin.name != name:
        return f"carry that name, and not {plugin.name!r}"
    if plugin.better not in ("higher", "lower", None):
        return f"be better 'higher', 'lower' or None, and not {plugin.better!r}"
    if not callable(plugin.function):
        return f"have a function, and not {plugin.function!r}"
    return ""
