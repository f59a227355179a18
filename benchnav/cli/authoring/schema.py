"""`benchnav schema`: the JSON Schema of a scenario or suite file."""

import json
from enum import StrEnum
from typing import Annotated

import typer

from benchnav.cli.console import one_of, put


class Of(StrEnum):
    """The kind of file that a schema describes."""

    SCENARIO = "scenario"
    SUITE = "suite"


def schema(
    of: Annotated[str, typer.Argument(metavar="OF", help="scenario or suite.")] = Of.SCENARIO.value,
) -> None:
    """Print the JSON Schema of scenario files or suite files.

    Editors use it to complete and check files (JSON Schema 2020-12).
    """
    if one_of(Of, "OF", of) == Of.SUITE:
        from benchnav.runner.plan.suite_file import json_schema
    else:
        from benchnav.scenario.load import json_schema
    put(json.dumps(json_schema(), indent=2, ensure_ascii=False))
