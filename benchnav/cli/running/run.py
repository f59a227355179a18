"""`benchnav run`: execute a suite."""

from benchnav.cli.console import put, say
from benchnav.cli.running import run_options as options


def run(
    suite: options.Suite,
    out: options.Out = None,
    workers: options.Workers = None,
    timeout: options.Timeout = None,
    memory: options.Memory = None,
    executor: options.Executor = "local",
    address: options.Address = None,
    shard: options.Shard = None,
    seeds: options.Seeds = None,
    navigator: options.Navigator = None,
    scenario: options.Scenario = None,
    track: options.Track = None,
    perception: options.Perception = None,
    salt: options.Salt = None,
    isolate: options.Isolate = False,
    again: options.Again = False,
    quiet: options.Quiet = False,
    debug: options.Debug = False,
) -> None:
    """Execute a suite into a run folder.

    Scenarios × tracks × perceptions × navigators × seeds. Prints the run folder on stdout;
    `benchnav leaderboard` makes the table from it.
    """
    from benchnav.api.execution.run import run as execute

    found = execute(
        suite, navigators=navigator, scenarios=scenario, tracks=track,
        perception=perception, seeds=seeds, out=out,
        workers=workers, timeout=timeout, memory=memory, executor=executor, address=address,
        shard=shard, salt=salt, isolate=isolate, again=again, quiet=quiet, debug=debug,
    )  # fmt: skip
    if not quiet:
        say(f"The table: benchnav leaderboard {found.path}")
    put(str(found.path))
