"""A scene with a number that is changed."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace

from iva.forces import Drive, Harmonic
from iva.parameters import Absorber, Primary, Start
from iva.scenes import scene

TYPE_CHECKING = False  # as in iva/__init__.py
if TYPE_CHECKING:
    from typing import Any


@dataclass(frozen=True, slots=True)
class Scene:
    """The scene of a branch, with the number that is changed."""

    absorber: Absorber
    primary: Primary
    force: Drive
    start: Start
    over: str

    def part(self, name: str) -> tuple[str, str]:
        """Return the part of the scene that has a number, and the name of the number there.

        Raises
        ------
        ValueError
            If no part has it.
        """
        part, _, plain = name.rpartition(".")
        # Which of several forces has it, a name does not say.
        parts = ("absorber", "primary") + (("force",) if isinstance(self.force, Harmonic) else ())
        for key in parts:
            has = plain in (one.name for one in fields(getattr(self, key)))
            if has and part in ("", key):
                return key, plain
        raise ValueError(f"{name}: no such number of the absorber, the primary system or the force")

    def given(self, name: str) -> float:
        """Return a number of the scene.

        Raises
        ------
        ValueError
            If the scene does not give it.
        """
        key, plain = self.part(name)
        value = getattr(getattr(self, key), plain)
        if not isinstance(value, (int, float)):
            raise ValueError(f"{name} is missing: give the scene by the numbers that are changed")
        return float(value)

    def at(self, value: float) -> Scene:
        """Return the scene with another value of the number that is changed."""
        key, plain = self.part(self.over)
        return replace(self, **{key: replace(getattr(self, key), **{plain: value})})

    def spec(self) -> dict[str, Any]:
        """Return the whole scene for the compiled part."""
        return scene(self.absorber, self.primary, self.start, self.force, {})
