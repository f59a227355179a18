"""Runs tasks on another machine, in a worker process, and returns the files of their parts."""

import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from hashlib import sha256
from pathlib import Path
from shutil import rmtree
from tempfile import mkdtemp

from benchnav.errors import BenchnavError
from benchnav.plugins import Registration
from benchnav.runner.execute.executor import WorkerPool
from benchnav.runner.execute.progress import Progress
from benchnav.runner.plan.limits import Limits
from benchnav.runner.plan.task import Outcome, Task
from benchnav.store.parts.part import FILES, SEAL, Part
from benchnav.store.runs.manifest import versions
from benchnav.store.runs.scenario_files import FOLDER, stage_files
from benchnav.system.temporary_folder import TemporaryFolder


@dataclass(frozen=True)
class Delivery:
    """A finished task, or a finished piece of one."""

    task: Task
    outcome: Outcome
    files: Mapping[str, bytes]  # of its part, by suffix; empty if nothing was stored


@dataclass(frozen=True)
class Refusal:
    """A BenchnavError that a task raised."""

    name: str
    text: str


class RayWorker:
    """Runs tasks in one worker process, as the local executor does.

    Navigators run in the worker process, so this actor survives their crashes and charges them.
    If the actor itself dies, its machine failed, and no navigator is charged.
    """

    def __init__(
        self, limits: Limits, path: Sequence[str], registrations: Sequence[Registration] = ()
    ) -> None:
        sys.path += [folder for folder in path if folder not in sys.path]
        main = sys.modules["__main__"]  # the script that started Ray: no worker must run it
        main.__spec__, main.__file__ = None, None
        self._home = TemporaryFolder("ray")
        self._folders: dict[str, Path] = {}  # of scenarios' files, by hash
        self._pool = WorkerPool(1, Progress(), limits, registrations)

    def versions(self) -> dict[str, str]:
        """Return the versions of the packages that affect results, on this machine."""
        return versions()

    def work(
        self, task: Task, files: Mapping[str, bytes], undisturbed: Mapping[str, bytes] = {}
    ) -> list[Delivery] | Refusal:
        """Run a task on a machine that may have none of its files.

        ``files`` are those of its scenario, ``undisturbed`` those of the undisturbed episodes of
        its worlds, by name.
        """
        try:
            folder = self._home.path / "parts" / task.job.key
            here = replace(task, folder=folder, undisturbed=self._received(undisturbed))
            finished = self._pool.run([self._staged(here, files)])
            return [self._delivery(task, piece, outcome) for piece, outcome in finished]
        except BenchnavError as error:
            return Refusal(type(error).__name__, str(error))

    def close(self) -> None:
        """Stop the worker process, and remove all files."""
        self._pool.close()
        self._home.remove()

    def _received(self, undisturbed: Mapping[str, bytes]) -> Path | None:
        """Return the folder of the undisturbed episodes of a task; those of others are removed."""
        folder = self._home.path / "undisturbed"
        rmtree(folder, ignore_errors=True)
        if not undisturbed:
            return None
        folder.mkdir()
        for name, content in undisturbed.items():
            (folder / name).write_bytes(content)
        return folder

    def _delivery(self, original: Task, piece: Task, outcome: Outcome) -> Delivery:
        part, files = Part(piece.folder, piece.first, piece.stop), {}
        for path in [part.path(suffix) for suffix in (*FILES, SEAL)]:
            if path.exists():
                files[path.name.removeprefix(part.stem)] = path.read_bytes()
                path.unlink()
        done = replace(
            piece, folder=original.folder, job=original.job, undisturbed=original.undisturbed
        )
        return Delivery(done, outcome, files)

    def _staged(self, task: Task, files: Mapping[str, bytes]) -> Task:
        """Return the task with a scenario whose files exist on this machine."""
        scenario = task.job.scenario
        if all((scenario.folder / name).is_file() for name in files):
            return task
        home = self._home.path
        if scenario.hash not in self._folders:
            (home / FOLDER).mkdir(exist_ok=True)
            shas = {name: sha256(content).hexdigest() for name, content in files.items()}
            for name, content in files.items():
                (home / FOLDER / shas[name]).write_bytes(content)
            self._folders[scenario.hash] = stage_files(home, shas, Path(mkdtemp(dir=home)))
        moved = scenario.moved_to(self._folders[scenario.hash])
        return replace(task, job=replace(task.job, scenario=moved))
