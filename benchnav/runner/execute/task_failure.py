"""The failure of a task, and whether a navigator can have caused it."""

from dataclasses import dataclass

from benchnav.errors import BenchnavError, named


@dataclass(frozen=True)
class TaskFailure:
    """Why a task failed."""

    cause: str  # ends the sentence "the navigator's process …"
    new_process: bool  # whether no other task had run in the worker process
    internal: bool = False  # whether no code of a navigator had run in the process
    killed_externally: bool = False  # whether another process may have killed it
    error_name: str = ""  # the class of the BenchnavError that was raised
    error_text: str = ""

    def error(self) -> Exception:
        """Return the exception to raise if no navigator caused the failure."""
        if self.error_name:
            return named(self.error_name, self.error_text)
        if self.error_text:
            return RuntimeError(f"A worker process crashed:\n{self.error_text}")
        return BenchnavError(
            f"A worker process {self.cause} (see stderr)."
            " A script must call this under `if __name__ == '__main__':`; 0 workers need none."
        )
