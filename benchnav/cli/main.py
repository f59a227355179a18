"""The command `benchnav`: one file per verb; heavy imports wait until a verb needs them."""

import sys
from collections.abc import Sequence
from typing import Annotated, Any

import typer

import benchnav
from benchnav.api.output.messages import options_as_flags
from benchnav.cli.authoring.import_map import movingai, ros_map
from benchnav.cli.authoring.import_recording import recording
from benchnav.cli.authoring.import_world import image, mesh, sdf, wkt
from benchnav.cli.authoring.new import new_app
from benchnav.cli.authoring.schema import schema
from benchnav.cli.authoring.validate import validate
from benchnav.cli.console import put, say
from benchnav.cli.machine_fault import machine_fault
from benchnav.cli.running.export import export
from benchnav.cli.running.merge import merge
from benchnav.cli.running.pack import pack
from benchnav.cli.running.run import run
from benchnav.cli.running.train import train
from benchnav.cli.running.verify import verify
from benchnav.cli.stopping import report_stop, stop_on_signals, stoppable
from benchnav.cli.tables.compare import compare
from benchnav.cli.tables.leaderboard import leaderboard
from benchnav.cli.tables.score import score
from benchnav.cli.viewing.doctor import doctor
from benchnav.cli.viewing.list import list_
from benchnav.cli.viewing.replay import replay
from benchnav.cli.viewing.report import report
from benchnav.cli.viewing.show import show
from benchnav.cli.viewing.watch import watch
from benchnav.errors import (
    BenchnavError,
    InputError,
    MissingExtraError,
    NoRunError,
    PluginError,
    UnsolvableError,
    UsageError,
)
from benchnav.navigation.plugin.trace import notes, trace
from benchnav.system.streams import drop, prepare_streams

DEBUG, HELP = "--debug", {"-h", "--help"}
_Usage: type[Any] = typer.BadParameter.mro()[2]  # click's UsageError; typer moves its module
_USAGE_ERRORS = (
    UsageError, InputError, PluginError, UnsolvableError, MissingExtraError, NoRunError,
)  # fmt: skip

app = typer.Typer(
    name="benchnav",
    help="Crowd navigation in unknown and dynamic environments: every method measured alike.",
    epilog=(
        "Exit status: 0 done, 1 the work failed, 2 wrong usage, 130 interrupted (143 by SIGTERM,"
        " 129 by SIGHUP)."
    ),
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
    context_settings={"help_option_names": sorted(HELP), "max_content_width": 100},
)
app.command("run")(stoppable(run))
app.command("leaderboard")(stoppable(leaderboard))
app.command("verify")(stoppable(verify))
app.command("pack")(stoppable(pack))
app.command("compare")(stoppable(compare))
app.command("export")(stoppable(export))
app.command("score")(stoppable(score))
app.command("merge")(stoppable(merge))
app.command("replay")(stoppable(replay))
app.command("report")(stoppable(report))
app.command("watch")(stoppable(watch))
app.command("train")(stoppable(train))
app.command("list")(stoppable(list_))
app.command("show")(stoppable(show))
app.command("validate")(stoppable(validate))
app.command("schema")(stoppable(schema))
import_app = typer.Typer(
    help="Convert a map, a world or a recording of people into a scenario.", no_args_is_help=True
)
for command in (movingai, ros_map, sdf, mesh, wkt, image, recording):
    import_app.command(command.__name__.replace("_", "-"))(stoppable(command))
app.add_typer(import_app, name="import")
app.add_typer(new_app, name="new")
app.command("doctor")(stoppable(doctor))


def _version(requested: bool) -> None:
    if requested:
        put(f"{benchnav.__version__}\n{_build_facts()}")
        raise typer.Exit


def _build_facts() -> str:
    """Return the commit, if known, the processor and the version of Python."""
    from benchnav.store.runs.provenance import commit, processor

    code = commit()
    dirty = ", with changes that are not committed" if code["dirty"] else ""
    lines = [f"commit     {code['commit']}{dirty}"] if code["commit"] else []
    return "\n".join([*lines, f"processor  {processor()}", f"python     {sys.version.split()[0]}"])


@app.callback()
def _options(
    version: Annotated[
        bool,
        typer.Option("--version", help="Print the version.", callback=_version, is_eager=True),
    ] = False,
    debug: Annotated[bool, typer.Option(DEBUG, help="Print the traceback of an error.")] = False,
) -> None:
    """Handle the options before a verb."""


def status(arguments: Sequence[str]) -> int:
    """Run the command with ``arguments``, and return the exit status."""
    with options_as_flags():
        return _status(arguments)


def _status(arguments: Sequence[str]) -> int:
    try:
        if [*arguments[:1]] == ["run"] and not {*arguments} & HELP:
            from benchnav.processes.fork_server import fork_server

            fork_server()  # starts while this process imports what parses the options
        code = app(list(arguments), standalone_mode=False)
    except BenchnavError as error:
        say(f"benchnav: {error}")
        if isinstance(error, NoRunError):
            say("This command creates a run folder: benchnav run SUITE --out FOLDER")
        if DEBUG in arguments:
            say(notes(error) or trace(error))
        return 2 if isinstance(error, _USAGE_ERRORS) else 1
    except KeyboardInterrupt as stopped:
        return report_stop(stopped)
    except typer.Abort as aborted:
        return report_stop(aborted.__cause__)
    except SystemExit as left:  # after completion, or if the reader of the help left
        return 0 if left.code in (0, None) or isinstance(left.__context__, BrokenPipeError) else 1
    except (OSError, MemoryError, ImportError, RuntimeError) as error:
        if not (sentence := machine_fault(error)):
            raise
        drop(sys.stdout)
        say(f"benchnav: {sentence}")
        if DEBUG in arguments:
            say(trace(error))
        return 1
    except _Usage as error:
        error.show()
        return 2
    return code if isinstance(code, int) else 0


def main() -> None:
    """Run the command: its entry point."""
    prepare_streams()
    stop_on_signals()
    raise SystemExit(status(sys.argv[1:]))
