"""Objects that return their records as text or as a data frame, and write them to files."""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from os import PathLike
from typing import TYPE_CHECKING, Any

from benchnav.api.output.text_table import written

if TYPE_CHECKING:
    import pandas as pd


class Exports(ABC):
    """An object with records. Each ``to_…`` method also writes its text to ``path`` if given."""

    @property
    @abstractmethod
    def records(self) -> Sequence[Any]:
        """The plain records, one for each row of the CSV file."""

    @property
    @abstractmethod
    def _record_type(self) -> type:
        """The dataclass of the records."""

    @abstractmethod
    def text(self, format: str) -> str:
        """Return the object as text in a format."""

    def to_markdown(self, path: "str | PathLike[str] | None" = None) -> str:
        """Return the object as Markdown, for people."""
        return written(self.text("markdown"), path)

    def to_csv(self, path: "str | PathLike[str] | None" = None) -> str:
        """Return every record with every field as CSV."""
        return written(self.text("csv"), path)

    def to_json(self, path: "str | PathLike[str] | None" = None) -> str:
        """Return every record with every field as JSON."""
        return written(self.text("json"), path)

    def to_pandas(self) -> "pd.DataFrame":
        """Return a data frame with the columns and rows of the CSV file."""
        import pandas as pd

        from benchnav.leaderboard.rendering.long_format import column_names

        columns = column_names(self._record_type, self.records)
        rows = [[getattr(record, name) for name in columns] for record in self.records]
        return pd.DataFrame(rows, columns=columns)
