"""The options of `benchnav run`."""

from pathlib import Path
from typing import Annotated

import typer

Suite = Annotated[
    str,
    typer.Argument(
        metavar="SUITE|SCENARIO", help="Name of a suite or scenario that ships, or a file."
    ),
]
Out = Annotated[
    Path | None,
    typer.Option(
        metavar="DIR",
        help="Run folder; the same suite continues there, also with more seeds. [default: new]",
    ),
]
Workers = Annotated[
    int | None,
    typer.Option(metavar="N", min=0, max=1024, help="Processes. [default: one per core]"),
]
Timeout = Annotated[
    float | None,
    typer.Option(
        metavar="S",
        help="A call of a navigator that lasts longer fails its episode. [default: 300]",
    ),
]
Memory = Annotated[
    float | None,
    typer.Option(metavar="GB", help="So does one whose process holds more memory. [default: 4]"),
]
Executor = Annotated[str, typer.Option(help="local, or ray (extra): a Ray cluster.")]
Address = Annotated[
    str | None,
    typer.Option(
        metavar="ADDRESS",
        help="Of the Ray cluster: auto, host:port, ray://host:port. [default: this machine]",
    ),
]
Shard = Annotated[
    str | None,
    typer.Option(
        metavar="I/N", help="Only this share of the episodes; `benchnav merge` joins them."
    ),
]
Seeds = Annotated[str | None, typer.Option(metavar="N|A:B", help="Seeds 0 … N-1, or A … B-1.")]
Navigator = Annotated[
    list[str] | None,
    typer.Option(
        metavar="NAME",
        help="Only this one of the suite, or any other, also '{type: name, …}'. Repeatable.",
    ),
]
Scenario = Annotated[
    list[str] | None,
    typer.Option(metavar="NAME", help="Instead of the suite's: name or file. Repeatable."),
]
Track = Annotated[
    list[str] | None, typer.Option(metavar="NAME", help="Instead of the suite's. Repeatable.")
]
Perception = Annotated[
    list[str] | None,
    typer.Option(metavar="NAME", help="exact or noisy, instead of the suite's. Repeatable."),
]
Salt = Annotated[
    str | None,
    typer.Option(
        metavar="HEX",
        help="Of navigators' randomness, to repeat a run: its manifest has it. [default: new]",
    ),
]
Isolate = Annotated[
    bool,
    typer.Option(
        "--isolate", help="Every navigator in a process of its own that is sent messages."
    ),
]
Again = Annotated[
    bool,
    typer.Option("--again", help="Run again what older code made; it is kept until all is there."),
]
Quiet = Annotated[bool, typer.Option("--quiet", help="Print errors only.")]
Debug = Annotated[
    bool, typer.Option("--debug", help="Print the tracebacks of what plugins raised.")
]
