"""The reference run of a suite, and what is kept of it: ``python -m studies.reference_run RUN``.

Executes the suite `standard` with ten seeds into the folder RUN (one that was broken off goes
on), verifies all of it, packs it beside itself, and writes into docs/leaderboard,
by the version N of the suite:

* ``standard-N.md``: the page, with the tables over all scenarios;
* ``standard-N.csv``: every record of the leaderboard, by the metrics of the page;
* ``standard-N.json``: salt, hashes, versions, the pack's sha256, the digest of every episode;
* ``standard-N-report.tar.xz``: its report with a few replays, without the files of libraries;
  the documentation site shows it;
* ``standard-N-sample.bnrun``: a few of its scenarios with one seed, verified here and in CI.
"""

import argparse
import csv
import io
import json
import os
import shutil
import tarfile
from collections.abc import Iterator
from datetime import datetime
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import pyarrow.parquet as pq

from benchnav.api.output.messages import message
from benchnav.api.records.run import open_run
from benchnav.leaderboard.from_runs import stored_values
from benchnav.report.page import ASSETS
from benchnav.report.shared_files import LIBRARIES, write_libraries
from benchnav.runner.execute.progress import progress
from benchnav.runner.plan.suite import Selection, load_suite
from benchnav.runner.run import run_suite
from benchnav.store.packs.pack import SUFFIX, content_digest, pack
from benchnav.store.parts.part import EPISODES_FILE, REHEARSALS_FILE
from benchnav.store.runs.reading import read_episodes
from benchnav.store.runs.run_folder import RunFolder
from benchnav.store.runs.scenario_files import sha256_of
from benchnav.verify.verify import Wanted, verify
from studies.paper.markdown import table

SUITE = "standard"
SEEDS = 10
SALT = "0123456789abcdef0123456789abcdef"  # public, so that the run can be repeated
METRICS = ("success", "collided", "spl")
SAMPLE = ("circle/antipodal:agents=8", "leaders/dynamic", "trap/u")
REPLAYS = 10  # in the report
DIGITS = 16  # of a digest that is kept


def execute(folder: Path, seeds: int, scenarios: tuple[str, ...] = ()) -> RunFolder:
    """Run the suite, or go on with it."""
    wanted = Selection(scenarios=scenarios, seeds=str(seeds), salt=SALT)
    run_suite(load_suite(SUITE, wanted), folder, progress=progress(quiet=False))
    return RunFolder.open(folder)


def digests(run: RunFolder) -> dict[str, dict[str, dict[str, list[str]]]]:
    """Scenario → track → navigator → the first digits of each seed's digest."""
    found: dict[str, dict[str, dict[str, list[str]]]] = {}
    for episode in read_episodes(run.path):
        identity = episode.identity
        cells = found.setdefault(identity.scenario, {}).setdefault(identity.track, {})
        cells.setdefault(identity.navigator, []).append(episode.digest[:DIGITS])
    return found


def lasted(run: RunFolder) -> float:
    """[s] from its first to its last file."""
    began = datetime.fromisoformat(run.manifest.created).timestamp()
    seals = (path.stat().st_mtime for path in run.path.glob("parts/*/*.json"))
    return max(seals) - began


def facts(run: RunFolder, packed: Path, seconds: float) -> dict[str, Any]:
    """Return the identity of the run and its cost."""
    manifest = run.manifest
    return {
        "suite": f"{manifest.suite['name']}@{manifest.suite['version']}",
        "suite_hash": manifest.suite_hash,
        "salt": manifest.salt,
        "seeds": manifest.suite["seeds"],
        "created": manifest.created,
        "seconds": round(seconds),
        "cores": len(os.sched_getaffinity(0)),
        "platform": manifest.platform,
        "versions": dict(manifest.versions),
        "pack": {
            "bytes": packed.stat().st_size,
            "sha256": sha256_of(packed),
            "content": content_digest(run),
        },
        "episodes": _rows(run, EPISODES_FILE),
        "rehearsals": _rows(run, REHEARSALS_FILE),
        "digests": {
            scenario: {
                track: {navigator: " ".join(found) for navigator, found in navigators.items()}
                for track, navigators in tracks.items()
            }
            for scenario, tracks in digests(run).items()
        },
    }


def _rows(run: RunFolder, suffix: str) -> int:
    paths = (part.path(suffix) for part in run.parts())
    return sum(pq.read_metadata(path).num_rows for path in paths if path.exists())


def records(run: RunFolder) -> tuple[str, list[dict[str, str]]]:
    """The leaderboard as CSV, and row by row."""
    text = stored_values([run], notify=message).text("csv", METRICS)
    return text, list(csv.DictReader(io.StringIO(text)))


def page(run: RunFolder, summary: dict[str, Any], rows: list[dict[str, str]], note: str) -> str:
    """The page, in Markdown."""
    reasons = [cell["reason"] for cell in run.manifest.cells]
    suite, packed = run.manifest.suite, summary["pack"]
    name = f"{suite['name']}-{suite['version']}"
    lines = [
        f"# The reference run of `{summary['suite']}`",
        "",
        f"{len(suite['scenarios'])} scenarios × {len(suite['tracks'])} tracks ×"
        f" {len(suite['navigators'])} navigators × {SEEDS} seeds of the test split, made and"
        " written by `python -m studies.reference_run`. Navigators without a map ran once for all"
        " tracks.",
        "",
        *table(
            ["", ""],
            [
                ["episodes", f"{summary['episodes']:,}, and {summary['rehearsals']:,} rehearsals"],
                ["cells", f"{reasons.count(''):,}; {len(reasons) - reasons.count(''):,} are n/a"],
                ["begun", summary["created"]],
                [
                    "took",
                    f"{summary['seconds'] / 60:.1f} minutes on {summary['cores']} cores{note}",
                ],
                ["platform", summary["platform"]],
                ["versions", ", ".join(f"{k} {v}" for k, v in summary["versions"].items())],
                ["hash of the suite", f"`{summary['suite_hash']}`"],
                ["salt", f"`{summary['salt']}`"],
                ["pack", f"{packed['bytes'] / 1e6:.0f} MB, sha256 `{packed['sha256']}`"],
                ["sha256 of its content", f"`{packed['content']}`"],
                ["`benchnav verify`", summary["verified"]],
                ["`benchnav verify`, sample", summary["sample"]],
            ],
        ),
        f'The <a href="{name}-report/index.html">report of the run</a> (on the documentation site)'
        " shows every scenario and navigator, any two navigators compared, and failures.",
        "",
        *_how(name, summary),
        "## Over all scenarios",
        "",
        *_overall(run),
        "## Success by scenario",
        "",
        "Per cent of the evaluated agents, n/a as –. Intervals and the other metrics are in"
        f" [{name}.csv]({name}.csv).",
        "",
    ]
    for track in suite["tracks"]:
        lines += [f"### {track}", "", *_matrix([r for r in rows if r["track"] == track])]
    return "\n".join(lines)


def _how(name: str, summary: dict[str, Any]) -> Iterator[str]:
    yield from (
        "## Check it",
        "",
        f"- `benchnav run {SUITE} --seeds {SEEDS} --salt {summary['salt']}` repeats it. Episodes"
        f" have the digests of [{name}.json]({name}.json) if they do not depend on a clock; learned"
        " navigators may differ on another type of processor.",
        f"- `benchnav verify {name}-sample.bnrun` checks a sample of it"
        f" ([{name}-sample.bnrun]({name}-sample.bnrun): {', '.join(f'`{s}`' for s in SAMPLE)}, seed"
        " 0) without running a navigator. CI does the same, and runs some of its navigators again.",
        f"- All 100 seeds: `benchnav run {SUITE} --out runs/{SUITE}`, which can be continued"
        " after a stop; `--shard I/N` and `benchnav merge` distribute it to several machines.",
        "",
    )


def _overall(run: RunFolder) -> Iterator[str]:
    """The sections over all scenarios of the whole leaderboard."""
    text = stored_values([run], notify=message).text("markdown", METRICS)
    for chapter in text.split("\n## "):
        head, *sections = chapter.removeprefix("## ").split("\n### ")
        kept = [s for s in sections if s.startswith("all scenarios")]
        if kept:
            yield f"### {head.strip()}"
            yield ""
        for section in kept:
            title, _, rest = section.partition("\n")
            yield f"#### {title}"
            yield rest.rstrip()
            yield ""


def _matrix(rows: list[dict[str, str]]) -> list[str]:
    """Success in per cent, scenarios × navigators."""
    rows = [r for r in rows if r["metric"] == "success" and "/" in r["scenario"]]
    labels = list(dict.fromkeys(r["navigator"] for r in rows))
    found = {(r["scenario"], r["role"], r["navigator"]): r["value"] for r in rows}
    places = list(dict.fromkeys((r["scenario"], r["role"]) for r in rows))
    cells = [
        [f"{scenario}, {role}s", *(_percent(found.get((scenario, role, n), "")) for n in labels)]
        for scenario, role in places
    ]
    return table(["", *labels], cells)


def _percent(text: str) -> str:
    return f"{100 * float(text):.0f}" if text not in ("", "nan") else "–"


def keep_report(run: RunFolder, out: Path) -> None:
    """Write the report to the archive ``out``: equal pages make equal bytes."""
    with TemporaryDirectory() as folder, tarfile.open(out, "w:xz") as archive:
        report = Path(folder) / "report"
        with open_run(run.path) as opened:
            opened.report(report, replays=REPLAYS)
        for path in sorted(report.rglob("*")):
            if path.is_file() and path.name not in LIBRARIES:
                facts = tarfile.TarInfo(path.relative_to(report).as_posix())
                facts.size = path.stat().st_size
                with path.open("rb") as file:
                    archive.addfile(facts, file)


def unpack_report(archive: Path, folder: Path) -> Path:
    """Unpack an archive of `keep_report` into a new folder in ``folder``, and complete it."""
    report = folder / archive.name.removesuffix(".tar.xz")
    shutil.rmtree(report, ignore_errors=True)
    with tarfile.open(archive) as packed:
        packed.extractall(report, filter="data")
    write_libraries(report / ASSETS)
    return report


def keep_sample(out: Path, every: dict[str, Any]) -> str:
    """Run the sample, see that it is one, verify it, pack it to ``out``; the verdict in words."""
    with TemporaryDirectory() as folder:
        run = execute(Path(folder) / "sample", 1, SAMPLE)
        for scenario, tracks in digests(run).items():
            for track, navigators in tracks.items():
                for navigator, (first,) in navigators.items():
                    if every[scenario][track][navigator].split()[0] != first:
                        print(f"{scenario}, {track}, {navigator}: another episode than in the run")
        verdict = verify_run(run)
        out.unlink(missing_ok=True)
        pack(run, out)
    return verdict


def verify_run(run: RunFolder) -> str:
    """Return the verdict of `verify` as text; print the findings."""
    report = verify(run, Wanted(), progress=progress(quiet=False))
    for finding in report.few(20):
        print(finding)
    return f"{len(report.findings)} findings. {'; '.join(report.checked)}"


def main() -> None:
    """Run, verify, pack, write."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("run", type=Path)
    parser.add_argument("--out", type=Path, default=Path("docs/leaderboard"))
    parser.add_argument("--seconds", type=float, help="that it took, if not in one go until now")
    parser.add_argument("--note", default="", help="a note beside the duration")
    options = parser.parse_args()
    run = execute(options.run, SEEDS)
    seconds = lasted(run) if options.seconds is None else options.seconds
    packed = options.run.with_name(options.run.name + SUFFIX)
    packed.unlink(missing_ok=True)
    pack(run, packed)
    summary = facts(run, packed, seconds)
    text, rows = records(run)
    name = f"{run.manifest.suite['name']}-{run.manifest.suite['version']}"
    options.out.mkdir(parents=True, exist_ok=True)
    summary["verified"] = verify_run(run)
    summary["sample"] = keep_sample(options.out / f"{name}-sample{SUFFIX}", summary["digests"])
    keep_report(run, options.out / f"{name}-report.tar.xz")
    (options.out / f"{name}.csv").write_text(text, encoding="utf-8")
    (options.out / f"{name}.json").write_text(
        json.dumps(summary, indent=1) + "\n", encoding="utf-8"
    )
    (options.out / f"{name}.md").write_text(
        page(run, summary, rows, options.note), encoding="utf-8"
    )
    print(options.out / f"{name}.md")
    if not all(summary[key].startswith("0 findings") for key in ("verified", "sample")):
        raise SystemExit("The run or its sample is not verified; see the findings above.")


if __name__ == "__main__":
    main()
