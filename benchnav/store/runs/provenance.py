"""The code, the machine and the command that made a run. No result depends on it."""

import json
import os
import platform
import shlex
import subprocess
import sys
from collections.abc import Mapping
from contextlib import suppress
from importlib.metadata import PackageNotFoundError, distribution
from pathlib import Path
from typing import Any

LONGEST = 2_000  # characters of a command line
_ROOT = Path(__file__).parents[3]
_PATIENCE = 5.0  # [s] for a program that is asked


def provenance() -> dict[str, Any]:
    """Return commit, dirty flag, processor and command line, as a manifest keeps them."""
    return {**commit(), "processor": processor(), "command": command_line()}


def commit() -> dict[str, Any]:
    """Return the commit that benchnav runs from, and whether files differ from it.

    The commit is "" for a release that was installed from an archive.
    """
    if (_ROOT / ".git").exists() and (_ROOT / "pyproject.toml").exists():
        found = _output("git", "-C", str(_ROOT), "rev-parse", "HEAD")
        changes = _output("git", "--no-optional-locks", "-C", str(_ROOT), "status", "--porcelain")
        return {"commit": found, "dirty": bool(found and changes)}
    with suppress(PackageNotFoundError, ValueError, TypeError, AttributeError):
        source = json.loads(distribution("benchnav").read_text("direct_url.json") or "{}")
        return {"commit": str(source.get("vcs_info", {}).get("commit_id", "")), "dirty": False}
    return {"commit": "", "dirty": False}


def processor() -> str:
    """Return the model of the processor; its architecture where the model is unknown."""
    model = ""
    with suppress(OSError):  # Linux
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8", errors="replace").splitlines()
        names = [line.partition(":")[2] for line in lines if line.startswith("model name")]
        model = names[0] if names else ""
    if sys.platform == "darwin":
        model = _output("sysctl", "-n", "machdep.cpu.brand_string")
    return (model.strip() or platform.processor() or platform.machine())[:200]


def command_line() -> str:
    """Return the command of this process, with ``~`` for the home folder, cut to `LONGEST`."""
    words = [Path(sys.argv[0]).name, *sys.argv[1:]] if sys.argv else []
    text = shlex.join(words)
    with suppress(RuntimeError):  # a user without a home
        text = text.replace(f"{Path.home()}/", "~/")
    return text if len(text) <= LONGEST else text[: LONGEST - 1] + "…"


def sentence(fields: Mapping[str, Any]) -> str:
    """Return the provenance of a manifest in words; "" for a run of 0.1, which has none."""
    dirty = " with changes that were not committed" if fields.get("dirty") else ""
    parts = {
        "commit": f", commit {fields.get('commit')}{dirty}",
        "processor": f", processor {fields.get('processor')!r}",
        "command": f", command {fields.get('command')!r}",
    }
    return "".join(text for key, text in parts.items() if fields.get(key))


def _output(*command: str) -> str:
    """Return what a program prints; "" where it fails or is missing."""
    with suppress(OSError, subprocess.SubprocessError):
        done = subprocess.run(  # noqa: S603 - fixed programs
            command, capture_output=True, text=True, check=True, timeout=_PATIENCE,
            stdin=subprocess.DEVNULL,
            env={k: v for k, v in os.environ.items() if not k.startswith("GIT_")},
        )  # fmt: skip
        return done.stdout.strip()
    return ""
