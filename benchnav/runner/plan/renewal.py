"""The episodes of older code, which are kept until all of their navigator have run again."""

from collections.abc import Mapping
from dataclasses import dataclass

from benchnav.errors import RunConflictError
from benchnav.store.runs.manifest import Manifest
from benchnav.store.runs.run_folder import RunFolder


@dataclass(frozen=True)
class Renewal:
    """The episodes to be replaced in a run.

    New episodes are written to separate folders, which no reader sees before `finish` names
    them in the manifest. A run that is stopped before keeps all old episodes.
    """

    planned: Manifest  # of the suite with the code that is installed now
    older: Mapping[str, int]  # label → number of stored episodes of other code

    @classmethod
    def of(cls, folder: RunFolder, planned: Manifest) -> "Renewal":
        """Return the episodes in ``folder`` of code other than that in ``planned``."""
        held, older = folder.manifest, {}
        for label in planned.sources:
            same = held.source_of(label) == planned.source_of(label)
            if not same or held.files_of(label) != planned.files_of(label):
                older[label] = sum(
                    len(folder.done(c["key"])) for c in held.cells if c["navigator"] == label
                )
        return cls(planned, older)

    @property
    def episodes(self) -> int:
        """The number of stored episodes of other code."""
        return sum(self.older.values())

    def refuse(self, folder: RunFolder) -> None:
        """Raise RunConflictError if there are episodes of other code."""
        if not self.episodes:
            return
        labels = [label for label, count in self.older.items() if count]
        unknown = [label for label in labels if not folder.manifest.source_of(label)]
        count = f"{self.episodes} episode{'s were' if self.episodes > 1 else ' was'}"
        why = f"{count} made by older code; the option 'again' repeats them"
        if unknown:
            why += f" (whose source was not recorded then: {', '.join(unknown)})"
        raise RunConflictError(
            f"source changed: {why}. They are of {', '.join(map(repr, labels))}, and stay in"
            f" {folder.path} until then. Another folder keeps both."
        )

    def target(self, folder: RunFolder) -> RunFolder:
        """Return the folder as it will be after `finish`; nothing is written."""
        renewed = folder.manifest.with_sources_of(self.planned, self.older)
        return RunFolder(folder.path, renewed if self.older else folder.manifest)

    def begin(self, folder: RunFolder) -> RunFolder:
        """Store the new sources of labels without episodes. Return the resulting folder."""
        fresh = [label for label, count in self.older.items() if not count]
        if not fresh:
            return folder
        return RunFolder(folder.path, folder.manifest.with_sources_of(self.planned, fresh)).kept()

    def finish(self, folder: RunFolder) -> dict[str, int]:
        """Replace the episodes of each label with no missing new ones. Return label → count."""
        target = self.target(folder)
        incomplete = {target.label_of(key) for key, _ in target.missing()}
        done = {label: n for label, n in self.older.items() if n and label not in incomplete}
        if done:
            manifest = folder.manifest.with_sources_of(self.planned, done)
            folder = RunFolder(folder.path, manifest).kept()
            folder.drop_others(target)
        return done
