"""The findings and counts of a verification."""

from collections import Counter
from dataclasses import dataclass, field
from itertools import zip_longest

from benchnav.text.plural import counted

KINDS = {  # subject of a finding → the condition that must hold
    "changed": "the run does not change while it is verified",
    "manifest": "the suite, its cells and hashes match each other",
    "scenario": "a scenario matches its hash, and its files are present",
    "coverage": "every cell has every seed once, and no other content",
    "seal": "files match the size and sha256 in the seal of their part",
    "identity": "episodes name their own cell and seed",
    "world": "the stored world is the one that scenario, split and seed draw",
    "command": "commands are such as a navigator may have given",
    "state": "re-simulated commands lead to the stored states, bit for bit",
    "event": "and to the stored collision events",
    "digest": "digests match the stored content",
    "rehearsal": "granted and charged rehearsals match those that were made",
    "metric": "values are those measured on the re-simulated episode, within 1e-9",
    "timing": "timings are possible",
    "twin": "the slow reference simulator agrees with the kernels",
    "referee": "trimesh and python-fcl judge every contact alike",
    "rerun": "the navigators, run again, give the same commands",
}


@dataclass(frozen=True, order=True)
class Finding:
    """A stored item that does not match the rest."""

    kind: str  # of KINDS
    where: str  # file, cell, seed
    what: str  # the stored item, and the expected one


@dataclass
class Report:
    """Findings, and counts of checks; reports of parts add up."""

    findings: list[Finding] = field(default_factory=list)
    counts: Counter[str] = field(default_factory=Counter)
    notes: Counter[str] = field(default_factory=Counter)  # unchecked items, and their numbers
    unknown: set[str] = field(default_factory=set)  # metrics that are not installed here
    unmeasured: set[str] = field(default_factory=set)  # installed metrics that a part does not have
    versions: list[str] = field(default_factory=list)  # of packages that differ from the run's
    sources: list[str] = field(default_factory=list)  # a sentence for each navigator
    claims: str = ""  # statements of the manifest that cannot be checked
    caveats: list[str] = field(
        default_factory=list
    )  # differences of the run from what is installed
    content: str = ""  # digest of the verified run

    @property
    def clean(self) -> bool:
        """Whether there is no finding."""
        return not self.findings

    def find(self, kind: str, where: str, what: str) -> None:
        """Add a finding."""
        self.findings.append(Finding(kind, where, what))

    def add(self, other: "Report") -> None:
        """Add the content of another report."""
        self.findings += other.findings
        self.counts += other.counts
        self.notes += other.notes
        self.unknown |= other.unknown
        self.unmeasured |= other.unmeasured

    def sort(self) -> None:
        """Sort findings by kind, causes before their consequences."""
        order = list(KINDS)
        self.findings.sort(key=lambda f: (order.index(f.kind), f.where, f.what))

    def few(self, most: int) -> list[Finding]:
        """Return at most ``most`` findings, some of every kind."""
        kinds = [[f for f in self.findings if f.kind == kind] for kind in KINDS]
        chosen = [f for turn in zip_longest(*kinds) for f in turn if f is not None][:most]
        return [f for f in self.findings if any(f is other for other in chosen)]

    @property
    def checked(self) -> list[str]:
        """Return sentences about the checks that were made."""
        c, n = self.counts, self._counted
        lines = [
            f"{n('episodes', 'episode')} and {n('rehearsals', 'rehearsal')}: worlds drawn again,"
            f" commands re-simulated, {n('states', 'state')} of agents and {n('events', 'event')}"
            f" bit for bit; {n('values', 'value')} within 1e-9"
        ]
        if c["twin episodes"]:
            every = c["twin decisions"] + c["decisions without twin"]
            lines.append(
                f"{n('twin episodes', 'episode')} by the slow reference simulator:"
                f" {n('twin decisions', 'decision')}"
                f"{f' of {every}' if c['decisions without twin'] else ''},"
                f" {n('twin events', 'event')}"
            )
        if c["judged states"]:
            lines.append(
                f"{n('judged events', 'event')} by trimesh and python-fcl, and"
                f" {n('judged states', 'state')} of agents for missing events"
            )
        if c["rerun"]:
            lines.append(f"{n('rerun', 'episode')} by running their navigators again")
        return lines

    def _counted(self, key: str, noun: str) -> str:
        return counted(self.counts[key], noun)

    @property
    def unchecked(self) -> list[str]:
        """Return sentences about what was not checked."""
        c = self.counts
        lines = [
            f"timings, which cannot be verified: {c['values of timings']} values match the"
            " stored seconds, and no more can be checked"
        ]
        if self.claims:
            lines.append(f"statements of the author about the run: {self.claims}")
        if not c["rerun"]:
            lines.append(
                "whether the navigators gave these commands (the option 'rerun' checks it)"
            )
        if c["n/a cells"] and not c["rerun n/a"]:
            lines.append(f"why cells are n/a ({c['n/a cells']}), as navigators report it ('rerun')")
        if self.unmeasured:
            names = ", ".join(sorted(self.unmeasured))
            lines.append(f"metrics that are installed here and not measured in the run: {names}")
        lines += [f"{n} × {text}" for text, n in sorted(self.notes.items())]
        return lines
