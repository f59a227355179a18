"""The navigator `process`: a program in any language, in a process of its own."""

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

PROCESS = "process"  # its name


class Program(Remote):
    """A program that answers frames on its standard input and output; see docs/isolation.md.

    It is isolated wherever it runs. A file of its command is found from where benchnav was
    started; the program itself starts in an empty folder of its own.
    """

    class Config(PluginConfig):
        """Parameters."""

        command: tuple[str, ...] = Field(
            min_length=1, description="the program and its arguments: [./my_navigator, --fast]"
        )
        config: dict[str, Any] = Field({}, description="what the program is told in `hello`")
        patience: float | None = Field(
            None, gt=0, description="[s] for a call, until it counts as hung; none: as the run says"
        )

        @field_validator("command")
        @classmethod
        def _check_command(cls, command: tuple[str, ...]) -> tuple[str, ...]:
            if shutil.which(command[0]) is None:
                raise ValueError(f"a program that can be executed; {command[0]!r} cannot")
            return command

    def start(self) -> Process:
        sandbox.require_fence()
        program, *arguments = self.config.command
        found = str(Path(shutil.which(program) or program).absolute())
        return Process([found, *(_whole(argument) for argument in arguments)])

    @property
    def hello(self) -> Mapping[str, Any]:
        return {"config": self.config.config}

    @property
    def patience(self) -> float:
        asked: float | None = self.config.patience
        return super().patience if asked is None else asked

    @property
    def fingerprint(self) -> str:
        """Of the files that its command names."""
        program, *arguments = self.config.command
        digest = hashlib.sha256()
        named = [program] if os.sep in program else []  # not what is found on the PATH
        for name in (*named, *arguments):
            if Path(name).is_file():
                digest.update(hashlib.sha256(Path(name).read_bytes()).digest())
        return digest.hexdigest()[:16]


def _whole(argument: str) -> str:
    """The absolute path where an argument names a file; else the argument."""
    return str(Path(argument).absolute()) if Path(argument).is_file() else argument
