"""The navigator `process`: a program in any language, in a separate process."""

import hashlib
import os
import shutil
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from pydantic import Field, field_validator

from benchnav.isolation import sandbox
from benchnav.isolation.navigator_process import Process
from benchnav.isolation.remote_navigator import Remote
from benchnav.navigation.navigator import PluginConfig

PROCESS = "process"  # the name of this navigator


class Program(Remote):
    """A program that answers frames on its standard input and output; see docs/isolation.md.

    It is always isolated. Files in its command are found relative to the folder where benchnav
    started; the program itself starts in an empty folder of its own.
    """

    class Config(PluginConfig):
        """Parameters."""

        command: tuple[str, ...] = Field(
            min_length=1, description="the program and its arguments: [./my_navigator, --fast]"
        )
        config: dict[str, Any] = Field({}, description="what the program receives in `hello`")
        patience: float | None = Field(
            None, gt=0, description="[s] time limit of a call; none: the limit of the run"
        )

        @field_validator("command")
        @classmethod
        def _check_command(cls, command: tuple[str, ...]) -> tuple[str, ...]:
            if shutil.which(command[0]) is None:
                raise ValueError(f"an executable program; {command[0]!r} cannot be executed")
            return command

    def start(self) -> Process:
        sandbox.require_sandbox()
        program, *arguments = self.config.command
        found = str(Path(shutil.which(program) or program).absolute())
        return Process([found, *(_absolute(argument) for argument in arguments)])

    @property
    def hello(self) -> Mapping[str, Any]:
        return {"config": self.config.config}

    @property
    def patience(self) -> float:
        limit: float | None = self.config.patience
        return super().patience if limit is None else limit

    @property
    def fingerprint(self) -> str:
        """Return a digest of the files that the command names."""
        program, *arguments = self.config.command
        digest = hashlib.sha256()
        named = [program] if os.sep in program else []  # a program found on the PATH does not count
        for name in (*named, *arguments):
            if Path(name).is_file():
                digest.update(hashlib.sha256(Path(name).read_bytes()).digest())
        return digest.hexdigest()[:16]


def _absolute(argument: str) -> str:
    """Return the absolute path if the argument names a file, else the argument."""
    return str(Path(argument).absolute()) if Path(argument).is_file() else argument
