"""The units of a result, column by column."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
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
    millimetres : bool, default False
        Whether lengths are in mm, where those of `system` would be in m.

    Examples
    --------
    >>> Units("si")["impacts"]["time"]
    's'
    >>> print(Units("si"))
    SI units: kg, N/m, N s/m, m, s, J
    """

    system: str
    swept: tuple[str, ...] = ()
    millimetres: bool = False

    @property
    def sentence(self) -> str:
        """One sentence that says it all."""
        said = _iva.column_units(self.system, [])[0]
        return said.replace(" m,", " lengths in mm,") if self.millimetres else said

    def in_mm(self) -> Units:
        """Return the same with lengths in mm.

        Raises
        ------
        ValueError
            If lengths are not in metres.
        """
        if self.system != "si":
            rule = "give primary.mass with stiffness or natural_frequency for SI units"
            raise ValueError(f"in_mm: lengths are in no unit of their own here ({self}); {rule}")
        return replace(self, millimetres=True)

    def __getitem__(self, table: str) -> Mapping[str, str]:
        """Return column → unit of a table; "1" is a plain number, "" is not a number.

        Raises
        ------
        KeyError
            If there is no such table.
        """
        units = _iva.column_units(self.system, list(self.swept))[1][table]
        if self.millimetres:
            units = {name: "mm" if unit == "m" else unit for name, unit in units.items()}
        return MappingProxyType(units)

    def __str__(self) -> str:
        """Return the sentence."""
        return self.sentence


def given_in_mm(fields: Iterable[str]) -> bool:
    """Return whether any length of a scene or of the axes of a sweep was given in mm.

    Examples
    --------
    >>> given_in_mm(["absorber.gap_mm", "start.displacement"]), given_in_mm(["clearance"])
    (True, False)
    """
    return any(field.endswith("_mm") for field in fields)


def from_metadata(metadata: Mapping[str, str], swept: Iterable[str] = ()) -> Units:
    """Return the units that the metadata of a table state."""
    return Units(metadata["iva.units"], tuple(swept))
