"""`benchnav schema`: the JSON Schema of a scenario, suite or robot file."""

import json
from typing import Annotated

import typer

from benchnav.cli.console import put


def schema(
    of: Annotated[str, typer.Argument(metavar="OF", help="scenario, suite or robot.")] = "scenario",
) -> None:
    """Print the JSON Schema of scenario, suite or robot files.

    Editors use it to complete and check files (JSON Schema 2020-12).
    """
    from benchnav.api.authoring.schema import schema as schema_of

    put(json.dumps(schema_of(of), indent=2))  # ASCII: valid JSON in every code page
