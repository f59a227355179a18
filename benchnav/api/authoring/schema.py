"""The JSON Schema of scenario and suite files."""

from typing import Any

from benchnav.errors import UsageError, did_you_mean

KINDS = ("scenario", "suite")


def schema(kind: str = "scenario") -> dict[str, Any]:
    """Return the JSON Schema (2020-12) of scenario files or suite files, as plain data.

    Editors use it to complete and check files.

    Args:
        kind: "scenario" or "suite".

    Raises UsageError for another kind.
    """
    if kind not in KINDS:
        raise UsageError(
            f"A schema must be that of a {' or '.join(KINDS)} file. Got {kind!r} instead."
            f"{did_you_mean(str(kind), KINDS)}"
        )
    if kind == "suite":
        from benchnav.runner.plan.suite_file import json_schema
    else:
        from benchnav.scenario.load import json_schema
    return json_schema()
