"""Episodes that older code made: found, kept, and replaced once all of them were run again."""

from collections.abc import Mapping
from dataclasses import dataclass

from benchnav.errors import RunConflictError
from benchnav.store.runs.manifest import Manifest
from benchnav.store.runs.run_folder import RunFolder


@dataclass(frozen=True)
class Renewal:
    """What is to be replaced in a run.

    The new episodes stand in folders of their own, which no reader sees before `finish`
    has the manifest name them. So a run that is stopped on the way holds the old ones, whole.
    """

    asked: Manifest  # of the suite with the code that is installed now
    older: Mapping[str, int]  # label → stored episodes that other code made

    @classmethod
    def of(cls, folder: RunFolder, asked: Manifest) -> "Renewal":
        """Return what ``asked`` finds in ``folder`` that was made by other code."""
        held, older = folder.manifest, {}
        for label in asked.sources:
            same = held.source_of(label) == asked.source_of(label)
            if not same or held.files_of(label) != asked.files_of(label):
                older[label] = sum(
                    len(folder.done(c["key"])) for c in held.cells if c["navigator"] == label
                )
        return cls(asked, older)

    @property
    def episodes(self) -> int:
        """How many stored episodes other code made."""
        return sum(self.older.values())

    def refuse(self, folder: RunFolder) -> None:
        """Raise RunConflictError where there are episodes of other code."""
        if not self.episodes:
            return
        labels = [label for label, count in self.older.items() if count]
        unknown = [label for label in labels if not folder.manifest.source_of(label)]
        count = f"{self.episodes} episode{'s were' if self.episodes > 1 else ' was'}"
        why = f"{count} made by older code; --again runs them"
        if unknown:
            why += f" (whose source was not recorded then: {', '.join(unknown)})"
        raise RunConflictError(
            f"source changed: {why}. They are of {', '.join(map(repr, labels))}, and stay in"
            f" {folder.path} until then (in Python: again=True). Another --out keeps both."
        )

    def target(self, folder: RunFolder) -> RunFolder:
        """Return the folder as it is to be when `finish` is done; nothing is written."""
        renewed = folder.manifest.with_sources_of(self.asked, self.older)
        return RunFolder(folder.path, renewed if self.older else folder.manifest)

    def begin(self, folder: RunFolder) -> RunFolder:
        """Take over the code of labels that have no episodes; return the folder that holds now."""
        fresh = [label for label, count in self.older.items() if not count]
        if not fresh:
            return folder
        return RunFolder(folder.path, folder.manifest.with_sources_of(self.asked, fresh)).kept()

    def finish(self, folder: RunFolder) -> dict[str, int]:
        """Replace the episodes of every label that was run again whole: label → how many."""
        target = self.target(folder)
        lacking = {label for key, _ in target.missing() for label in [target.label_of(key)]}
        done = {label: n for label, n in self.older.items() if n and label not in lacking}
        if done:
            manifest = folder.manifest.with_sources_of(self.asked, done)
            folder = RunFolder(folder.path, manifest).kept()
            folder.drop_others(target)
        return done
