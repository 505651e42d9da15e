"""A scene with a number that is changed."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace

from iva.forces import Drive, Harmonic
from iva.parameters import Absorbers, Primary, Start
from iva.scenes import scene
from iva.structures import Structure

TYPE_CHECKING = False  # as in iva/__init__.py
if TYPE_CHECKING:
    from typing import Any


def has(part: object, name: str) -> bool:
    """Return whether a part of a scene has a number of this name."""
    return name in (one.name for one in fields(part))  # type: ignore[arg-type]


@dataclass(frozen=True, slots=True)
class Scene:
    """The scene of a branch, with the number that is changed."""

    absorber: Absorbers
    primary: Primary | Structure
    force: Drive
    start: Start
    over: str

    def part(self, name: str) -> tuple[str, int | None, str]:
        """Return the part of the scene that has a number, which of several, and its name there.

        Raises
        ------
        ValueError
            If no part has it.
        """
        place, _, plain = name.rpartition(".")
        place, _, number = place.partition(".")
        index = int(number) if number.isdecimal() else None
        # Which of several forces has it, a name does not say.
        known = ("absorber", "primary") + (("force",) if isinstance(self.force, Harmonic) else ())
        for key in known:
            part = getattr(self, key)
            parts = part if isinstance(part, (list, tuple)) else [part]
            chosen = parts if index is None else parts[index : index + 1]
            if place in ("", key) and any(has(one, plain) for one in chosen):
                return key, index, plain
        raise ValueError(f"{name}: no such number of the absorber, the primary system or the force")

    def given(self, name: str) -> float:
        """Return a number of the scene.

        Raises
        ------
        ValueError
            If the scene does not give it.
        """
        key, index, plain = self.part(name)
        part = getattr(self, key)
        one = part[index or 0] if isinstance(part, (list, tuple)) else part
        value = getattr(one, plain, None)
        if not isinstance(value, (int, float)):
            raise ValueError(f"{name} is missing: give the scene by the numbers that are changed")
        return float(value)

    def at(self, value: float) -> Scene:
        """Return the scene with another value of the number that is changed."""
        key, index, plain = self.part(self.over)
        part = getattr(self, key)
        if not isinstance(part, (list, tuple)):
            return replace(self, **{key: replace(part, **{plain: value})})
        changed = [
            replace(one, **{plain: value}) if index in (None, k) and has(one, plain) else one
            for k, one in enumerate(part)
        ]
        given: dict[str, Any] = {key: changed}
        return replace(self, **given)

    def spec(self) -> dict[str, Any]:
        """Return the whole scene for the compiled part."""
        return scene(self.absorber, self.primary, self.start, self.force, {}, several=True)
