"""The units of a result, column by column."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from types import MappingProxyType

from iva import _iva


@dataclass(frozen=True, slots=True)
class Units:
    """Units of the tables of one result.

    Parameters
    ----------
    system : {"si", "seconds", "natural"}
        Which of the three cases holds.
    swept : tuple of str
        Keys of the swept parameters, columns of the summary as well.

    Examples
    --------
    >>> Units("si")["impacts"]["time"]
    's'
    >>> print(Units("si"))
    SI units: kg, N/m, N s/m, m, s, J
    """

    system: str
    swept: tuple[str, ...] = ()

    @property
    def sentence(self) -> str:
        """One sentence that says it all."""
        return _iva.column_units(self.system, [])[0]

    def __getitem__(self, table: str) -> Mapping[str, str]:
        """Return column → unit of a table; "1" is a plain number, "" is not a number.

        Raises
        ------
        KeyError
            If there is no such table.
        """
        return MappingProxyType(_iva.column_units(self.system, list(self.swept))[1][table])

    def __str__(self) -> str:
        """Return the sentence."""
        return self.sentence


def from_metadata(metadata: Mapping[str, str], swept: Iterable[str] = ()) -> Units:
    """Return the units that the metadata of a table state."""
    return Units(metadata["iva.units"], tuple(swept))
