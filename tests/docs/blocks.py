"""Takes documents apart and executes what they tell a reader to do."""

import os
import re
import shlex
import subprocess
import sys
import tomllib
from dataclasses import dataclass
from pathlib import Path

import yaml

ROOT = Path(__file__).parents[2]
FENCE = re.compile(r"^```(?P<language>\S*)\n(?P<text>.*?)^```$", re.MULTILINE | re.DOTALL)
NAMED = re.compile(r"# file: (?P<name>\S+)\n")
SHOWN = {"text", "markdown", "latex", "csv", "json", "bibtex"}  # read by people, not executed
SITE = {"{eval-rst}"}  # directives of the documentation site, which its build checks
FEWER = ["--seeds", "1", "--workers", "0"]
QUICKER = ["--scenario", "trap/u", "--track", "known"]


@dataclass(frozen=True)
class Block:
    """A fenced block of a document."""

    language: str
    text: str
    line: int


def documents():
    """Every document of the project."""
    return sorted([*ROOT.glob("*.md"), *ROOT.glob("docs/**/*.md"), *ROOT.glob("scenarios/**/*.md")])


def blocks(document):
    """Its fenced blocks, in order."""
    text = document.read_text(encoding="utf-8")
    return [
        Block(found["language"], found["text"], text.count("\n", 0, found.start()) + 1)
        for found in FENCE.finditer(text)
    ]


class Reader:
    """Somebody who follows a document, in an empty folder."""

    def __init__(self, folder):
        self.folder = folder
        self.installed = folder / ".installed"
        self.installed.mkdir()
        self.path = [str(folder), str(self.installed)]

    def follow(self, block):
        """Write the file that the block is, or do what it says."""
        named = NAMED.match(block.text)
        if named:
            target = self.folder / named["name"]
            target.parent.mkdir(parents=True, exist_ok=True)
            target.write_text(block.text, encoding="utf-8")
        elif block.language == "python":
            text = block.text.replace("seeds=20", "seeds=2, scenarios='trap/u'")
            self.call([sys.executable, "-W", "error", "-c", text])
        elif block.language == "shell":
            for line in block.text.splitlines():
                self.command(shlex.split(line, comments=True))
        else:
            assert block.language in SHOWN | SITE, f"line {block.line}: a {block.language!r} block"

    def command(self, words):
        match words:
            case []:
                return
            case ["benchnav", "run", suite, *_]:
                fewer = FEWER if "--seeds" not in words else FEWER[2:]
                if "ray" in words:
                    fewer = [*fewer[:-1], "1"]
                self.benchnav(
                    [*words[1:], *fewer, *(QUICKER if suite in ("quick", "learning") else [])]
                )
            case ["benchnav", "train", recipe, *rest] if not recipe.endswith(".yaml"):
                self.benchnav(["train", self.shortened(recipe), *rest])
            case ["pip", "install", "benchnav"]:
                return
            case ["pip", "install", package] if package.startswith("benchnav["):
                extras = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
                known = extras["project"]["optional-dependencies"]
                assert set(package[9:-1].split(",")) <= set(known), package
            case ["benchnav", "verify", *rest] if "--twin" not in rest:
                self.benchnav(["verify", *rest, "--twin", "1"])  # it is slow
            case ["benchnav", *rest]:
                self.benchnav(rest)
            case ["make", target]:
                targets = (ROOT / "Makefile").read_text(encoding="utf-8")
                assert re.search(rf"^{re.escape(target)}:", targets, re.MULTILINE), target
            case ["pip", "install", "-e", project]:
                self.install(self.folder / project)
            case ["pytest", *paths]:
                self.call([sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", *paths])
            case ["git", "clone", *_] | ["cd", _]:
                return
            case _:
                raise AssertionError(f"{shlex.join(words)}: nobody checks this command")

    def shortened(self, name):
        """A shipped recipe that ends after a few decisions."""
        path = ROOT / "baselines/learned/recurrent_ppo/recipes" / f"{name}.yaml"
        recipe = yaml.safe_load(path.read_text(encoding="utf-8"))
        recipe |= {"rows": 4, "checkpoint": 300, "validation": {"worlds": 2}}
        recipe["courses"] = [{**recipe["courses"][0], "worlds": 5}]
        recipe["stages"] = [{**recipe["stages"][0], "decisions": 300}]
        short = self.folder / f"{name}.yaml"
        short.write_text(yaml.safe_dump(recipe), encoding="utf-8")
        return str(short)

    def benchnav(self, arguments):
        code = "from benchnav.cli.main import main; main()"
        self.call([sys.executable, "-c", code, *arguments])

    def call(self, command):
        inherited = os.environ.get("PYTHONPATH", "")
        path = os.pathsep.join([*self.path, *([inherited] if inherited else [])])
        programs = os.pathsep.join([str(Path(sys.executable).parent), os.environ["PATH"]])
        done = subprocess.run(
            command, cwd=self.folder,
            env={**os.environ, "PYTHONPATH": path, "PATH": programs, "COLUMNS": "140"},
            capture_output=True, text=True, timeout=300, check=False,
        )  # fmt: skip
        assert done.returncode == 0, f"{shlex.join(command[2:])}\n{done.stdout}{done.stderr}"
        assert "Traceback" not in done.stderr

    def install(self, project):
        """What `pip install -e` leaves behind, without the network: metadata and a path."""
        said = tomllib.loads((project / "pyproject.toml").read_text(encoding="utf-8"))["project"]
        record = self.installed / f"{said['name'].replace('-', '_')}-{said['version']}.dist-info"
        record.mkdir()
        metadata = f"Metadata-Version: 2.1\nName: {said['name']}\nVersion: {said['version']}\n"
        (record / "METADATA").write_text(metadata, encoding="utf-8")
        lines = [
            line
            for group, entries in said["entry-points"].items()
            for line in (f"[{group}]", *(f"{name} = {value}" for name, value in entries.items()))
        ]
        (record / "entry_points.txt").write_text("\n".join(lines), encoding="utf-8")
        source = project / "src"
        self.path.append(str(source if source.is_dir() else project))
