"""What verifying a run finds, and what it counted on the way."""

from collections import Counter
from dataclasses import dataclass, field
from itertools import zip_longest

from benchnav.text.plural import counted

KINDS = {  # what a finding is about → what must hold there
    "changed": "nothing writes the run while it is verified",
    "manifest": "the suite, its cells and hashes fit each other",
    "scenario": "a scenario is what its hash says, and its files are there",
    "coverage": "every cell has every seed once, and nothing else is there",
    "seal": "files have the size and sha256 that their part was sealed with",
    "identity": "episodes say which cell and seed they are of",
    "world": "the stored world is the one that scenario, split and seed draw",
    "command": "commands are such as a navigator may have given",
    "state": "re-simulated commands lead to the stored states, bit for bit",
    "event": "and to the stored collision events",
    "digest": "digests are those of what is stored",
    "rehearsal": "what was granted and charged is what was rehearsed",
    "metric": "values are those measured on the re-simulated episode, within 1e-9",
    "timing": "timings are possible ones",
    "twin": "the slow twin of the kernels agrees",
    "referee": "trimesh and python-fcl judge every contact alike",
    "rerun": "the navigators, run again, answer the same",
}


@dataclass(frozen=True, order=True)
class Finding:
    """Something stored that does not agree with the rest."""

    kind: str  # of KINDS
    where: str  # file, cell, seed
    what: str  # what is stored, and what must be there


@dataclass
class Report:
    """Findings, and what was looked at; reports of parts add up."""

    findings: list[Finding] = field(default_factory=list)
    counts: Counter[str] = field(default_factory=Counter)
    notes: Counter[str] = field(default_factory=Counter)  # what was not checked, and how often
    unknown: set[str] = field(default_factory=set)  # metrics that are not installed here
    unmeasured: set[str] = field(default_factory=set)  # metrics that are here, and not in a part
    versions: list[str] = field(default_factory=list)  # of packages that differ from the run's
    sources: list[str] = field(default_factory=list)  # a sentence for each navigator
    claims: str = ""  # what the manifest says that nothing follows from
    caveats: list[str] = field(default_factory=list)  # where the run is not what is installed
    content: str = ""  # digest of what was verified

    @property
    def clean(self) -> bool:
        """True where nothing disagrees."""
        return not self.findings

    def find(self, kind: str, where: str, what: str) -> None:
        """Add a finding."""
        self.findings.append(Finding(kind, where, what))

    def add(self, other: "Report") -> None:
        """Take over what another one holds."""
        self.findings += other.findings
        self.counts += other.counts
        self.notes += other.notes
        self.unknown |= other.unknown
        self.unmeasured |= other.unmeasured

    def sort(self) -> None:
        """Findings by kind, causes before what follows from them."""
        order = list(KINDS)
        self.findings.sort(key=lambda f: (order.index(f.kind), f.where, f.what))

    def few(self, most: int) -> list[Finding]:
        """At most so many findings, some of every kind."""
        kinds = [[f for f in self.findings if f.kind == kind] for kind in KINDS]
        chosen = [f for turn in zip_longest(*kinds) for f in turn if f is not None][:most]
        return [f for f in self.findings if any(f is other for other in chosen)]

    @property
    def checked(self) -> list[str]:
        """What was checked, in words."""
        c, n = self.counts, self._counted
        lines = [
            f"{n('episodes', 'episode')} and {n('rehearsals', 'rehearsal')}: worlds drawn again,"
            f" commands re-simulated, {n('states', 'state')} of agents and {n('events', 'event')}"
            f" bit for bit; {n('values', 'value')} within 1e-9"
        ]
        if c["twin episodes"]:
            lines.append(
                f"{n('twin episodes', 'episode')} by the slow twin of the kernels:"
                f" {n('twin decisions', 'decision')}, {n('twin events', 'event')}"
            )
        if c["judged states"]:
            lines.append(
                f"{n('judged events', 'event')} by trimesh and python-fcl, and"
                f" {n('judged states', 'state')} of agents for events that lack"
            )
        if c["rerun"]:
            lines.append(f"{n('rerun', 'episode')} by running their navigators again")
        return lines

    def _counted(self, what: str, noun: str) -> str:
        return counted(self.counts[what], noun)

    @property
    def unchecked(self) -> list[str]:
        """What was not, in words."""
        c = self.counts
        lines = [
            f"timings, which nobody can verify: {c['values of timings']} values follow from the"
            " stored seconds, and that is all there is to say"
        ]
        if self.claims:
            lines.append(f"what its author says of the run: {self.claims}")
        if not c["rerun"]:
            lines.append("whether the navigators gave these commands (--rerun asks them)")
        if c["n/a cells"] and not c["rerun n/a"]:
            lines.append(f"why cells are n/a ({c['n/a cells']}), which navigators say (--rerun)")
        if self.unmeasured:
            names = ", ".join(sorted(self.unmeasured))
            lines.append(f"metrics that are installed here and not measured in the run: {names}")
        lines += [f"{n} × {text}" for text, n in sorted(self.notes.items())]
        return lines
