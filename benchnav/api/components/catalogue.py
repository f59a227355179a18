"""The installed components by kind: what `benchnav.available` returns."""

from collections.abc import Iterator, Mapping
from functools import cached_property
from typing import overload

from benchnav.api.components import listing
from benchnav.api.components.kind import Kind
from benchnav.api.components.listing import BROKEN, Entry
from benchnav.api.output.text_table import table_html
from benchnav.errors import UsageError, did_you_mean
from benchnav.text.columns import columns


class Catalogue(Mapping[str, str]):
    """The components of one kind: name → description in one line.

    The names are known without loading the components. The first description that is read loads
    all of the kind; a component that cannot be used has the reason as its description.
    """

    def __init__(self, kind: str) -> None:
        self.kind = kind

    @cached_property
    def names(self) -> tuple[str, ...]:
        """The names, sorted."""
        return tuple(listing.names(Kind(self.kind)))

    @cached_property
    def entries(self) -> tuple[Entry, ...]:
        """Name, origin and description of each component, and of broken packages."""
        return tuple(listing.entries(Kind(self.kind)))

    @property
    def broken(self) -> dict[str, str]:
        """The components that cannot be used, each with the reason."""
        return {each.name: each.description for each in self.entries if each.origin == BROKEN}

    def text(self, indent: str = "") -> str:
        """Return the entries as a table in text, as ``benchnav list`` prints it."""
        return columns([(indent + name, *rest) for name, *rest in self.entries])

    def __getitem__(self, name: str) -> str:
        if name not in self.names:
            raise KeyError(name)
        return self._descriptions[name]

    def __contains__(self, name: object) -> bool:
        return name in self.names

    def __iter__(self) -> Iterator[str]:
        return iter(self.names)

    def __len__(self) -> int:
        return len(self.names)

    @cached_property
    def _descriptions(self) -> dict[str, str]:
        return {each.name: each.description for each in self.entries}

    def __repr__(self) -> str:
        return f"Catalogue({self.kind}: {', '.join(self.names) or 'none'})"

    def __str__(self) -> str:
        return self.text()

    def _repr_html_(self) -> str:
        return table_html(self.kind.capitalize(), Entry._fields, self.entries)


@overload
def available(kind: str) -> Catalogue: ...
@overload
def available(kind: None = None) -> dict[str, Catalogue]: ...
def available(kind: str | None = None) -> Catalogue | dict[str, Catalogue]:
    """Return the components of a kind, name → description, as ``benchnav list`` shows them.

    A name can stand for a plugin that cannot be used, because the names need no import.

    Args:
        kind: navigators, planners, controllers, scenarios, robots, suites, metrics, trainers or
            recipes; None: all of them, kind → components.

    Raises UsageError for another kind.
    """
    kinds = [each.value for each in Kind]
    if kind is None:
        return {each: Catalogue(each) for each in kinds}
    if kind not in kinds:
        raise UsageError(
            f"The kind must be one of {', '.join(kinds)}. Got {kind!r} instead."
            f"{did_you_mean(str(kind), kinds)}"
        )
    return Catalogue(kind)
