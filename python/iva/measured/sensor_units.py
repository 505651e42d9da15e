"""Units of sensors: how they are spelt, what they measure, and their factors to SI.

g is standard gravity, 9.80665 m/s² (3rd CGPM, 1901); the inch is 25.4 mm, the foot 12 inches.
"""

from __future__ import annotations

import re
import unicodedata
from dataclasses import dataclass

#: m/s² in one g.
STANDARD_GRAVITY = 9.80665

#: Metres in a unit of length.
LENGTHS = {
    "m": 1.0,
    "dm": 1e-1,
    "cm": 1e-2,
    "mm": 1e-3,
    "um": 1e-6,
    "nm": 1e-9,
    "in": 0.0254,
    "inch": 0.0254,
    "ft": 0.3048,
    "mil": 0.0254e-3,
}

#: Accelerations that are not spelt as a length over seconds.
GRAVITIES = {
    "g": STANDARD_GRAVITY,
    "gn": STANDARD_GRAVITY,
    "g_n": STANDARD_GRAVITY,
    "mg": STANDARD_GRAVITY * 1e-3,
    "ug": STANDARD_GRAVITY * 1e-6,
    "Gal": 1e-2,
    "gal": 1e-2,
    "N/kg": 1.0,
}

#: Seconds in a unit of time.
TIMES = {
    "s": 1.0,
    "sec": 1.0,
    "second": 1.0,
    "seconds": 1.0,
    "Sekunde": 1.0,
    "Sekunden": 1.0,
    "ms": 1e-3,
    "msec": 1e-3,
    "us": 1e-6,
    "ns": 1e-9,
}

#: Newtons in a unit of force; a pound is 0.45359237 kg (agreement of 1959) under standard gravity.
FORCES = {"N": 1.0, "mN": 1e-3, "kN": 1e3, "MN": 1e6, "lbf": 0.45359237 * STANDARD_GRAVITY}

#: Parts of the names of forces: N behind another name is north.
OF_FORCES = ("force", "kraft", "load")

#: What the columns of something else than forces and motions are in.
OTHERS = {
    *("°C", "degC", "K", "°F", "V", "mV", "uV", "µV", "A", "mA", "%", "Pa", "kPa", "MPa", "bar"),
    *("mbar", "Nm", "N m", "N*m", "rad", "deg", "°", "Hz", "kHz", "rpm", "1/min", "um/m", "µm/m"),
    *("W", "kg"),
}

# A length, then what it is over: /s, _s, _per_s, *s^-1 with nothing, 2, ^2 or /s for accelerations.
OVER = re.compile(
    rf"(?P<length>{'|'.join(sorted(LENGTHS, key=len, reverse=True))})"
    r"(?:(?:/|_per_|_)\(?s(?:ec)?(?P<squared>\^?2|/s(?:ec)?|_2)?\)?"
    r"|[*_.]?s(?:ec)?\^?-(?P<power>[12]))?"
)
# At the end of a name, the longer one first: acceleration_m_s2, v_mm_per_s; then a1_g, x_mm.
SUFFIXES = tuple(
    re.compile(rf"(?P<name>.*[^_])_(?P<unit>{unit})")
    for unit in (r"[^\W_]+_per_[^\W_]+", r"[^\W_]+_[^\W_]+", r"[^_]+")
)
# Words that would be a unit, and mean something else more often.
NO_SUFFIX = {"in", "mil", "g_n"}
# Behind a name, in brackets: a1 [g], a1 (g), a1 {g}; or without: a1 / g, a1 / (m/s²), a1 in g.
BRACKETS = re.compile(r"(?P<name>.*?)[\s_]*(?:\[(?P<a>[^\[\]]*)\]|\((?P<b>.*)\)|\{(?P<c>[^{}]*)\})")
SLASH = re.compile(r"(?P<name>.*\S)\s+(?:/|in)\s+(?P<unit>\S.*)")


@dataclass(frozen=True, slots=True)
class Unit:
    """A unit of a sensor or of a clock.

    Parameters
    ----------
    text : str
        As it was spelt.
    quantity : {"acceleration", "velocity", "displacement", "time", "force"}
        What it measures.
    factor : float
        What one of it is in m/s², m/s, m, s or N.
    """

    text: str
    quantity: str
    factor: float

    def is_same(self, other: Unit) -> bool:
        """Return whether two spellings mean one unit."""
        return (self.quantity, self.factor) == (other.quantity, other.factor)


def unit_of(text: str) -> Unit | None:
    """Return the unit that a text spells, if it is known.

    Large and small letters differ (mg is no Mg), unless all letters are large, as in old files.

    Examples
    --------
    >>> unit_of("mm/s²"), unit_of("V")
    (Unit(text='mm/s²', quantity='acceleration', factor=0.001), None)
    >>> unit_of("g").factor
    9.80665
    """
    spelt = " ".join(text.split())
    # NFKC turns ² into 2, the micro sign into μ, and a full-width letter into a plain one.
    plain = unicodedata.normalize("NFKC", spelt).replace("−", "-").replace("μ", "u")
    plain = plain.replace("**", "^").replace("·", "*")
    if plain.isupper():
        plain = plain.lower()
    plain = re.sub(r"\s*([/*^-])\s*", r"\1", plain).replace(" ", "*")
    if plain in GRAVITIES:
        return Unit(spelt, "acceleration", GRAVITIES[plain])
    if plain in TIMES:
        return Unit(spelt, "time", TIMES[plain])
    if (found := OVER.fullmatch(plain)) is None:
        return None
    factor = LENGTHS[found["length"]]
    if found["squared"] or found["power"] == "2":
        return Unit(spelt, "acceleration", factor)
    quantity = "displacement" if plain == found["length"] else "velocity"
    return Unit(spelt, quantity, factor)


def unit_called(text: str) -> Unit | None:
    """Return the unit that a text spells, forces among them, if it is known."""
    return Unit(text, "force", FORCES[text]) if text in FORCES else unit_of(text)


def parted(header: str) -> tuple[str, str]:
    """Return the name and the text of the unit in the header of a column; '' if there is no unit.

    Brackets state a unit whether it is known or not, a suffix only if it is known.

    Examples
    --------
    >>> parted("a1 [g]"), parted("a / (m/s²)"), parted("displacement_mm"), parted("x_left")
    (('a1', 'g'), ('a', 'm/s²'), ('displacement', 'mm'), ('x_left', ''))
    >>> parted("acceleration_m_s2"), parted("t in s"), parted("signal_in")
    (('acceleration', 'm_s2'), ('t', 's'), ('signal_in', ''))
    """
    text = " ".join(header.split())
    if (found := SLASH.fullmatch(text)) and unit_of(bare(found["unit"])):
        return found["name"], bare(found["unit"])
    if found := BRACKETS.fullmatch(text):
        return found["name"], (found["a"] or found["b"] or found["c"] or "").strip()
    for pattern in SUFFIXES:
        found = pattern.fullmatch(text)
        if found and found["unit"] not in NO_SUFFIX and unit_of(found["unit"]):
            return found["name"], found["unit"]
    return text, ""


def bare(text: str) -> str:
    """Return the text of a unit without the brackets around it."""
    text = text.strip()
    whole = len(text) > 2 and (text[0], text[-1]) in {("[", "]"), ("(", ")"), ("{", "}")}
    return text[1:-1].strip() if whole else text
