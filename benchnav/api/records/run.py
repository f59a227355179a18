"""A run: the folder that executing a suite leaves, or a pack of it."""

import weakref
from collections.abc import Iterable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from functools import cached_property
from os import PathLike
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING, Any

from benchnav.api.output.messages import message
from benchnav.api.output.text_table import key_value_html
from benchnav.errors import UsageError
from benchnav.scenario.condition import EXACT, perceptions_of
from benchnav.store.packs.unpack import opened
from benchnav.store.runs.run_folder import RunFolder
from benchnav.store.runs.spans import count
from benchnav.text.plural import counted

if TYPE_CHECKING:
    from benchnav.api.records.comparison import Comparison
    from benchnav.api.records.curve import Curve
    from benchnav.api.records.episodes import Episodes
    from benchnav.api.records.leaderboard import Leaderboard
    from benchnav.api.records.verification import Verification
    from benchnav.runner.run import Summary

RunLike = "Run | str | PathLike[str]"


def open_run(path: "str | PathLike[str]", summary: "Summary | None" = None) -> "Run":
    """Open the run in a folder, or in a pack (``*.bnrun``).

    Raises NoRunError where there is none, CorruptPartError where a pack is damaged.
    """
    stack = ExitStack()
    return Run(stack.enter_context(opened(path)), stack, summary)


class Run:
    """A stored run. `benchnav.run` makes one, and `benchnav.open_run` opens one.

    Nothing is read before it is asked for. A pack is unpacked into a temporary folder until
    `close` is called, or the program ends.
    """

    def __init__(
        self, folder: RunFolder, stack: ExitStack | None = None, summary: "Summary | None" = None
    ) -> None:
        self.folder = folder  # the plain record
        self.summary = summary  # counts and failures of the execution; None: opened from disk
        self.close = weakref.finalize(self, (stack or ExitStack()).close)

    def __enter__(self) -> "Run":
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    @property
    def path(self) -> Path:
        """The run folder, or the pack."""
        return self.folder.shown

    @cached_property
    def navigators(self) -> tuple[str, ...]:
        """The labels of the navigators, in the order of the suite."""
        return tuple(entry["label"] for entry in self.folder.manifest.suite["navigators"])

    @cached_property
    def scenarios(self) -> tuple[str, ...]:
        """The scenarios with their versions, in the order of the suite."""
        return tuple(entry["scenario"] for entry in self.folder.manifest.suite["scenarios"])

    @property
    def tracks(self) -> tuple[str, ...]:
        """The tracks, in the order of the suite."""
        return tuple(self.folder.manifest.suite["tracks"])

    @property
    def perceptions(self) -> tuple[str, ...]:
        """The perceptions, in the order of the suite: exact, noisy."""
        return perceptions_of(self.folder.manifest.suite)

    @property
    def seeds(self) -> range:
        """The seeds."""
        return range(*self.folder.manifest.suite["seeds"])

    def leaderboard(
        self,
        *,
        metrics: str | Sequence[str] | None = None,
        columns: Sequence[str] | None = None,
        runs: "Iterable[Run | str | PathLike[str]]" = (),
        recompute: bool = False,
        verify: bool = False,
    ) -> "Leaderboard":
        """Return the table of this run: means, 95 % intervals, and ties shown as ties.

        Args:
            metrics: names of metrics, or "all"; None: the usual few.
            columns: the columns of every table in this order: metrics, and rank, mode,
                training, rehearsal, verified, middle_half.
            runs: other runs to show in the same table.
            recompute: measure the stored episodes again, with every installed metric.
            verify: first verify the runs that were not verified on this machine.
        """
        from benchnav.api.records.leaderboard import Leaderboard
        from benchnav.leaderboard.from_runs import stored_values
        from benchnav.runner.execute.progress import progress
        from benchnav.verify.receipts import with_receipts

        with self._with(runs) as folders:
            folders, verified = with_receipts(folders, verify, progress(False), message)
            values = stored_values(folders, recompute=recompute, verified=verified, notify=message)
        return Leaderboard(values, _names(metrics), columns)

    def compare(
        self,
        first: str,
        second: str,
        *,
        metrics: str | Sequence[str] | None = None,
        scenarios: str | Sequence[str] = (),
        runs: "Iterable[Run | str | PathLike[str]]" = (),
        recompute: bool = False,
    ) -> "Comparison":
        """Return the differences between two navigators, their sizes and their confidence.

        Args:
            first: the label of a navigator.
            second: the label of another one.
            metrics: names, or "all"; None: success, collided, spl, time_to_goal.
            scenarios: only these; empty: all.
            runs: other runs to join.
            recompute: measure the stored episodes again.
        """
        from benchnav.api.records.comparison import Comparison
        from benchnav.leaderboard.from_runs import comparison

        with self._with(runs) as folders:
            duel, known = comparison(
                folders, (first, second), metrics=_names(metrics),
                scenarios=_names(scenarios) or (), recompute=recompute, notify=message,
            )  # fmt: skip
        return Comparison(duel, known)

    def curve(
        self,
        axis: str,
        metric: str = "success",
        *,
        runs: "Iterable[Run | str | PathLike[str]]" = (),
        recompute: bool = False,
    ) -> "Curve":
        """Return a metric against a parameter of scenarios, or success against "horizon"."""
        from benchnav.api.records.curve import Curve
        from benchnav.leaderboard.from_runs import curve

        with self._with(runs) as folders:
            return Curve(curve(folders, axis, metric, recompute=recompute, notify=message))

    def verify(
        self,
        *,
        twin: int = 20,
        twin_seconds: float = 20.0,
        referee: str | None = None,
        rerun: bool = False,
        workers: int | None = None,
        quiet: bool = False,
    ) -> "Verification":
        """Check the run without its navigators, and return the findings.

        Worlds are drawn again, commands are simulated again, and metrics are measured again.
        A receipt on this machine then marks the run in leaderboards.

        Args:
            twin: episodes that the slow, plain simulator replays as well.
            twin_seconds: [s] of processor time for these replays; each has an equal share.
            referee: "fcl": judge every contact again with python-fcl.
            rerun: run the navigators again where they are deterministic.
            workers: processes; None: one per core; 0: this process.
            quiet: print no progress.
        """
        from benchnav.api.records.verification import Verification
        from benchnav.processes.main_module import stop_import_of_main
        from benchnav.runner.execute.progress import progress
        from benchnav.verify.receipts import write_receipt
        from benchnav.verify.verify import Wanted, verify

        stop_import_of_main()
        if referee not in (None, "fcl"):
            raise UsageError(f"The referee must be fcl. Got {referee!r} instead.")
        wanted, began = Wanted(twin, twin_seconds, referee is not None, rerun), perf_counter()
        report = verify(self.folder, wanted, workers=workers, progress=progress(quiet))
        seconds = perf_counter() - began
        write_receipt(self.folder, report, message)
        return Verification(str(self.path), report, seconds)

    def episodes(
        self,
        navigator: str | None = None,
        scenario: str | None = None,
        track: str | None = None,
        seed: int | None = None,
        *,
        perception: str | None = None,
        failed: bool | str = False,
        worst: str | None = None,
    ) -> "Episodes":
        """Return the stored episodes, or those of one navigator, scenario, condition or seed.

        A scenario may be named with or without version and parameters.

        Args:
            navigator: its label.
            scenario: its name.
            track: the knowledge track.
            seed: of the world.
            perception: exact or noisy.
            failed: True: only those in which an evaluated agent did not succeed; or a cause:
                "collided", "timeout", "stuck" or "failed" (the navigator failed).
            worst: a metric: they come in its order, worst first.

        Raises UsageError for a name, cause or metric that the run does not have.
        """
        from benchnav.api.records.episodes import stored_episodes

        found = stored_episodes(
            self.folder, navigator, scenario, track, perception, seed, owner=self
        )
        if failed is not False:
            from benchnav.api.records.episode_choice import failed_episodes

            cause = None if failed is True else failed
            found = failed_episodes(self.folder, found.places, owner=self, cause=cause)
        if worst is not None:
            from benchnav.api.records.episode_choice import worst_episodes

            found = worst_episodes(self.folder, found.places, worst, owner=self)
        return found

    def export(
        self,
        out: "str | PathLike[str]",
        *,
        to: str | None = None,
        navigator: str | None = None,
        scenario: str | None = None,
        track: str | None = None,
        perception: str | None = None,
        seed: int | None = None,
    ) -> list[Path]:
        """Write the trajectories of all or some episodes for other programs; return the files.

        Args:
            out: a file of one table that ends in .csv or .parquet; for PedPy, a folder.
            to: "csv", "parquet", or "pedpy": a text file that PedPy loads and a walkable area (WKT)
                for each episode; None: by the suffix of ``out``.
            navigator: its label; None: all.
            scenario: its name; None: all.
            track: the knowledge track; None: all.
            perception: exact or noisy; None: all.
            seed: of the world; None: all.

        Raises UsageError for a wrong format or name, StoreError if a file cannot be written.
        """
        from benchnav.api.output.export import export

        target = Path(out)
        found = self.episodes(navigator, scenario, track, seed, perception=perception)
        if not len(found):
            raise UsageError(
                f"There must be an episode to export. {self.path} holds none of these."
            )
        kind = to or target.suffix.lower().removeprefix(".") or "pedpy"
        return export((episode.record for episode in found), target, kind)

    def pack(self, out: "str | PathLike[str] | None" = None, *, quiet: bool = False) -> Path:
        """Write the run into one file, with everything that verifying it needs.

        Returns the file: ``out``, or the run folder's name with the suffix .bnrun.
        """
        from benchnav.store.packs.pack import SUFFIX, content_digest, pack

        default = self.path.with_name(self.path.resolve().name + SUFFIX)
        target = Path(out) if out is not None else default
        if target.suffix != SUFFIX:
            raise UsageError(f"The file of a pack must end in {SUFFIX}. Got {target} instead.")
        pack(self.folder, target)
        if not quiet:
            size = target.stat().st_size / 1e6
            message(f"{size:.1f} MB, content {content_digest(self.folder)}")
        return target

    def report(
        self,
        out: "str | PathLike[str]",
        *,
        runs: "Iterable[Run | str | PathLike[str]]" = (),
        metrics: str | Sequence[str] | None = None,
        replays: int | None = None,
        verify: bool = False,
        quiet: bool = False,
    ) -> Path:
        """Write a report: a folder of pages that opens from disk, and return its first page.

        Args:
            out: the folder; an earlier report there is replaced.
            runs: other runs to show in the same report.
            metrics: names of metrics on the leaderboard, or "all"; None: the usual ones and more.
            replays: the largest number of failed episodes that can be watched in it; None: 100.
            verify: first verify the runs that were not verified on this machine.
            quiet: print nothing.

        Raises UsageError where the folder holds something else.
        """
        from benchnav.api.records.report import write

        with self._with(runs) as folders:
            return write(
                folders, Path(out), metrics=_names(metrics), replays=replays, verify=verify,
                quiet=quiet,
            )  # fmt: skip

    def report_missing(self, notify: Any = message) -> None:
        """Print which episodes are missing; nothing for a complete run."""
        from benchnav.store.runs.completeness import missing_episodes

        for line in missing_episodes(self.folder):
            notify(line)

    @contextmanager
    def _with(self, runs: "Iterable[Run | str | PathLike[str]]") -> Iterator[list[RunFolder]]:
        """The folders of this run and of others, after a message on missing episodes."""
        with ExitStack() as stack:
            others = (
                run if isinstance(run, Run) else stack.enter_context(open_run(run)) for run in runs
            )
            every = [self, *others]
            for run in every:
                run.report_missing()
            yield [run.folder for run in every]

    def _facts(self) -> list[tuple[str, str]]:
        manifest = self.folder.manifest
        total = sum(count(seeds) for _, seeds in self.folder.planned())
        missing = sum(count(seeds) for _, seeds in self.folder.missing())
        return [
            ("suite", f"{manifest.suite['name']}@{manifest.suite['version']}"),
            ("scenarios", ", ".join(self.scenarios)),
            ("tracks", ", ".join(self.tracks)),
            *self._noisy(", ".join(self.perceptions)),
            ("navigators", ", ".join(self.navigators)),
            ("seeds", f"{self.seeds.start} to {self.seeds.stop - 1}"),
            ("episodes", f"{total - missing} of {total}"),
        ]

    def _noisy(self, value: Any) -> list[tuple[str, Any]]:
        """Return the value under its name, or nothing for a run of exact perception only."""
        return [] if self.perceptions == (EXACT,) else [("perception", value)]

    def __repr__(self) -> str:
        suite = self.folder.manifest.suite
        sizes = (
            (len(self.scenarios), "scenario"), (len(self.tracks), "track"),
            *((count, name) for name, count in self._noisy(len(self.perceptions))),
            (len(self.navigators), "navigator"), (len(self.seeds), "seed"),
        )  # fmt: skip
        product = " × ".join(counted(n, what) for n, what in sizes)
        return f"Run({str(self.path)!r}: {suite['name']}@{suite['version']}, {product})"

    def _repr_html_(self) -> str:
        return key_value_html(f"Run {self.path}", self._facts())


def _names(names: str | Sequence[str] | None) -> list[str] | None:
    if names is None:
        return None
    return [names] if isinstance(names, str) else list(names) or None
