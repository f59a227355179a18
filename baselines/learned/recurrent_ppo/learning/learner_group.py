"""Data-parallel learners: processes that collect each for themselves and average their gradients.

All processes run the same code with the same weights and draw different worlds. They meet at each
gradient through gloo, on the loopback interface; the process of rank 0 alone writes files.
"""

import os
import signal
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from multiprocessing import get_context
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import torch
import torch.distributed as dist

from benchnav.errors import BenchnavError, TrainingError
from benchnav.processes.fork_server import exit_text
from benchnav.processes.main_module import without_main
from benchnav.processes.process_tree import end_with_parent
from benchnav.threads import core_count

_PATIENCE = 5.0  # [s] for a process that ended, or must end
_THREADS = "BENCHNAV_THREADS"


class LearnerGroup:
    """The place of this process among the learners; alone by default."""

    def __init__(self, rank: int = 0, size: int = 1) -> None:
        self.rank, self.size = rank, size

    def gather(self, value: Any) -> list[Any]:
        """Return the value of every process, by rank."""
        values = [value] * self.size
        if self.size > 1:
            dist.all_gather_object(values, value)
        return values

    def share(self, count: int) -> int:
        """Return this process's part of ``count`` equal things."""
        return count * (self.rank + 1) // self.size - count * self.rank // self.size

    def average_gradients(self, policy: Any) -> None:
        """Replace each gradient of ``policy`` by the mean over all processes, from now on.

        A parameter that a stage sets itself, the noise of actions, has no gradient.
        """
        if self.size == 1:
            return
        parameters: list[Any] = list(policy.parameters())
        ready = 0

        def average(_: torch.Tensor) -> None:
            nonlocal ready
            ready += 1
            learned = [p for p in parameters if p.requires_grad]
            if ready < len(learned):
                return
            ready = 0
            flat = torch.cat([p.grad.flatten() for p in learned])
            dist.all_reduce(flat)
            flat /= self.size
            first = 0
            for p in learned:
                p.grad.copy_(flat[first : first + p.numel()].view_as(p))
                first += p.numel()

        for parameter in parameters:
            parameter.register_post_accumulate_grad_hook(average)


@contextmanager
def learner_group(size: int, work: Callable[..., None], *arguments: Any) -> Iterator[LearnerGroup]:
    """Yield the group of this process and ``size`` - 1 new ones, which run ``work``.

    They call ``work(group, *arguments)``, and end with this process. Raises TrainingError where
    one of them ends early.
    """
    if size == 1:
        yield LearnerGroup()
        return
    context, before = get_context("spawn"), os.environ.get(_THREADS)
    with TemporaryDirectory(prefix="benchnav-") as folder:
        meeting = str(Path(folder) / "meeting")
        others = [
            context.Process(
                target=_run, args=(rank, size, meeting, work, arguments), daemon=True,
                name=f"benchnav learner {rank}",
            )
            for rank in range(1, size)
        ]  # fmt: skip
        try:
            with without_main():
                for process in others:
                    process.start()
            _join(0, size, meeting)
            yield LearnerGroup(0, size)
            for process in others:
                process.join(_PATIENCE)
        except RuntimeError as error:  # gloo: the connection to a process is closed
            for process in others:
                process.join(_PATIENCE / size)
            ended = [f"{p.name} {exit_text(p.exitcode)}" for p in others if p.exitcode]
            if not ended:
                raise
            raise TrainingError(
                f"All {size} processes of a training must stay alive: {', '.join(ended)} (see"
                " above for the cause; memory may be short). The last checkpoint is kept: continue"
                " with resume."
            ) from error
        finally:
            for process in others:
                if process.pid is not None:
                    process.kill()
                    process.join()
            if dist.is_initialized():
                dist.destroy_process_group()
            os.environ.pop(_THREADS, None)
            if before is not None:
                os.environ[_THREADS] = before


def _join(rank: int, size: int, meeting: str) -> None:
    os.environ[_THREADS] = str(max(1, core_count() // size))
    os.environ["GLOO_SOCKET_IFNAME"] = "lo0" if sys.platform == "darwin" else "lo"
    dist.init_process_group("gloo", init_method=f"file://{meeting}", rank=rank, world_size=size)


def _run(
    rank: int, size: int, meeting: str, work: Callable[..., None], arguments: tuple[Any, ...]
) -> None:
    """Work in a new process: Ctrl-C is handled by its parent."""
    end_with_parent()
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    os.dup2(2, 1)
    torch.set_num_threads(1)
    try:
        _join(rank, size, meeting)
        work(LearnerGroup(rank, size), *arguments)
    except BenchnavError:
        sys.exit(1)  # all processes have the same error, and rank 0 reports it
    except RuntimeError as error:
        if "peer" not in str(error):  # the end of another process is reported by rank 0
            raise
        sys.exit(1)
