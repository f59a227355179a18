"""Try the wheel as its users get it: several Pythons, newest and lowest dependencies.

Every Python that is found gets an environment of its own, where the wheel is
installed without constraints, except the version of torch that constraints.txt
names. In an empty folder a suite is run, verified, tabled and read; where torch
is, a policy is trained too.

    python .ci/try_wheels.py                      several Pythons, as .ci/run does
    python .ci/try_wheels.py newest plan,view     this Python alone, with these extras
    python .ci/try_wheels.py lowest
"""

import os
import re
import subprocess
import sys
import tempfile
import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from shutil import which

ROOT = Path(__file__).resolve().parents[1]
SUITE = """\
name: tiny
scenarios: [trap/u]
tracks: [known]
navigators: [orca, straight-line]
seeds: 2
"""
RECIPE = """\
trainer: recurrent-ppo
name: tiny
courses: [{scenario: leaders/static, worlds: 20}]
rows: 8
network: {lstm_layers: 1, lstm_size: 16}
stages: [{decisions: 2048}]
checkpoint: 2048
validation: {worlds: 5}
"""
READ = """\
from pathlib import Path
import numpy
from benchnav.store.runs.reading import read_episodes
episodes = list(read_episodes(Path("run")))
assert len(episodes) == 4, len(episodes)
for episode in episodes:
    world = episode.world
    for array in (episode.position, world.agents.start, world.solids[0].loops[0]):
        assert isinstance(array, numpy.ndarray) and array.dtype == numpy.float64, type(array)
print("numpy", numpy.__version__)
"""


@dataclass(frozen=True)
class Trial:
    """One environment: a Python, its dependencies, and the extras that are installed."""

    python: str  # such as 3.12
    lowest: bool  # dependencies at the lowest versions that the wheel allows; else the newest
    extras: str = ""

    def __str__(self) -> str:
        return f"Python {self.python}, {'lowest' if self.lowest else 'newest'} dependencies"


TRIALS = (
    Trial("3.11", lowest=True, extras="[plan,learn,view]"),
    Trial("3.12", lowest=False, extras="[plan,view]"),
    Trial("3.13", lowest=False),
)


class FailedError(Exception):
    """A command failed; the text holds the command and what it printed."""


def main(*words: str) -> None:
    """Try every Python; exit with 1 where a trial fails or fewer than two Pythons are found."""
    if words:
        sys.exit(not alone(*words))
    found = {trial: interpreter(trial.python) for trial in TRIALS}
    for trial in (trial for trial, python in found.items() if python is None):
        print(f"{trial}: not tried, no such Python was found")
    ready = {trial: python for trial, python in found.items() if python}
    if len({trial.python for trial in ready}) < 2:
        sys.exit("The wheel must be tried on two Pythons at least; install another one.")
    with tempfile.TemporaryDirectory() as folder, ThreadPoolExecutor(2) as pool:
        wheel = build(Path(folder) / "dist")
        tries = [
            pool.submit(attempt, trial, python, wheel, Path(folder) / f"{number}")
            for number, (trial, python) in enumerate(ready.items())
        ]
        failures = sum(not done.result() for done in tries)
    sys.exit(failures > 0)


def alone(dependencies: str, extras: str = "") -> bool:
    """Try the wheel on this Python; return whether that went well."""
    version = ".".join(map(str, sys.version_info[:2]))
    trial = Trial(version, dependencies == "lowest", f"[{extras}]" if extras else "")
    with tempfile.TemporaryDirectory() as folder:
        wheel = build(Path(folder) / "dist")
        return attempt(trial, Path(sys.executable), wheel, Path(folder) / "0")


def interpreter(version: str) -> Path | None:
    """Return a working interpreter of this version; install one where a manager can."""
    for install in ((), ("uv", "python", "install", version), ("pyenv", "install", "-s", version)):
        if install and (not which(install[0]) or subprocess.run(install, check=False).returncode):
            continue
        for candidate in candidates(version):
            if works(candidate, version):
                return candidate
    return None


def candidates(version: str) -> list[Path]:
    """Return where an interpreter of this version may be: PATH, pyenv, uv."""
    places = [Path(p) / f"python{version}" for p in os.environ.get("PATH", "").split(os.pathsep)]
    pyenv = Path(os.environ.get("PYENV_ROOT") or Path.home() / ".pyenv")
    places += sorted(pyenv.glob(f"versions/{version}.*/bin/python{version}"), reverse=True)
    if which("uv"):
        command = ["uv", "python", "find", "--no-project", version]
        place = subprocess.run(command, check=False, capture_output=True, text=True).stdout.strip()
        places += [Path(place)] if place else []
    return [place for place in places if place.is_file()]


def works(python: Path, version: str) -> bool:
    """Whether it starts, is of this version, and can make environments."""
    code = "import ensurepip, sys, venv; print(*sys.version_info[:2], sep='.')"
    done = subprocess.run([python, "-c", code], check=False, capture_output=True, text=True)
    return done.returncode == 0 and done.stdout.strip() == version


def build(folder: Path) -> Path:
    """Build the wheel from the source distribution, as a release does."""
    command(ROOT, sys.executable, "-m", "build", "--outdir", str(folder), str(ROOT))
    (wheel,) = folder.glob("*.whl")
    return wheel


def attempt(trial: Trial, python: Path, wheel: Path, folder: Path) -> bool:
    """Install and use the wheel; print how it went, and whether it went well."""
    begin = time.monotonic()
    try:
        numpy = use(trial, install(trial, python, wheel, folder), folder / "empty")
    except FailedError as failure:
        print(f"{trial}: FAILED\n{failure}", flush=True)
        return False
    print(f"{trial} ({numpy}): passed in {time.monotonic() - begin:.0f} s", flush=True)
    return True


def install(trial: Trial, python: Path, wheel: Path, folder: Path) -> Path:
    """Return the folder of programs of a new environment that holds the wheel."""
    command(ROOT, str(python), "-m", "venv", str(folder))
    pins = floors(wheel) if trial.lowest else {}
    pins |= {"torch": torch_pin()}
    constraints = folder / "constraints.txt"
    constraints.write_text("".join(f"{name}=={pin}\n" for name, pin in pins.items()))
    pip = (str(folder / "bin" / "python"), "-m", "pip", "install", "--quiet")
    command(ROOT, *pip, "--upgrade", "pip")
    prebuilt = () if trial.lowest else ("--only-binary", ":all:")  # users need no compiler
    quick = (*pip, "--no-compile", *prebuilt)  # most modules are never imported here
    command(ROOT, *quick, "-c", str(constraints), f"{wheel}{trial.extras}")
    return folder / "bin"


def floors(wheel: Path) -> dict[str, str]:
    """Return the lowest version that the wheel allows of every package, of its extras too."""
    import zipfile

    with zipfile.ZipFile(wheel) as archive:
        (name,) = (n for n in archive.namelist() if n.endswith(".dist-info/METADATA"))
        metadata = archive.read(name).decode()
    return dict(re.findall(r"^Requires-Dist: ([\w.-]+)>=([\w.]+)", metadata, re.MULTILINE))


def torch_pin() -> str:
    """Return the version of torch that constraints.txt names: on Linux a build without CUDA."""
    text = (ROOT / "constraints.txt").read_text(encoding="utf-8")
    pin: str = re.findall(r"^torch==(.+)$", text, re.MULTILINE)[0]
    return pin if sys.platform == "linux" else pin.partition("+")[0]


def use(trial: Trial, programs: Path, folder: Path) -> str:
    """Run, verify, table and read a suite in an empty folder, and train; return NumPy's version."""
    folder.mkdir()
    (folder / "suite.yaml").write_text(SUITE)
    (folder / "recipe.yaml").write_text(RECIPE)
    benchnav = str(programs / "benchnav")
    command(folder, benchnav, "doctor")
    command(folder, benchnav, "run", "suite.yaml", "--workers", "1", "--out", "run")
    command(folder, benchnav, "verify", "run", "--twin", "0")
    for option in ((), ("--recompute",)):
        table = command(folder, benchnav, "leaderboard", "run", *option)
        if not ("orca" in table and "straight-line" in table):
            raise FailedError(f"The leaderboard must name both navigators.\n{table}")
    if "learn" in trial.extras:
        command(folder, benchnav, "train", "recipe.yaml", "--out", "training")
        if not (folder / "training" / "weights.safetensors").is_file():
            raise FailedError("The training left no weights.safetensors.")
    return command(folder, str(programs / "python"), "-c", READ).strip()


def command(folder: Path, *words: str) -> str:
    """Run a program in a folder, with caches beside it; return what it printed.

    Raises:
        FailedError: it failed, or printed a warning.
    """
    outside = ("PYTHONPATH", "PYTHONHOME", "VIRTUAL_ENV", "NUMBA_CACHE_DIR")
    settings = {name: value for name, value in os.environ.items() if name not in outside}
    if folder != ROOT:
        settings["XDG_CACHE_HOME"] = str(folder.parent / "cache")
    done = subprocess.run(
        words, check=False, cwd=folder, env=settings, text=True, encoding="utf-8",
        stdout=subprocess.PIPE, stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL,
    )  # fmt: skip
    if done.returncode or (folder != ROOT and re.search(r"\w*Warning:", done.stdout)):
        raise FailedError(f"$ {' '.join(words)}  (exit {done.returncode})\n{done.stdout[-6000:]}")
    return done.stdout


if __name__ == "__main__":
    main(*sys.argv[1:])
