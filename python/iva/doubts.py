"""A warning where a scene has what was hardly meant: a slip of units, or long contacts."""

from __future__ import annotations

from iva import _iva

TYPE_CHECKING = False  # as in iva/__init__.py
if TYPE_CHECKING:
    from typing import Any

    from iva.parameters import Spec

#: Where the names of fields end without which a scene without a mass is not looked at.
CONTACTS = ("contact_time", "contact_stiffness")


def warn_of_doubts(spec: Spec, points: tuple[Any, ...] | None = None) -> None:
    """Warn of what a scene has that was hardly meant.

    For public functions that are `spell_checked`: the warning points to the line that calls them.

    Parameters
    ----------
    spec : dict
        The scene.
    points : tuple, optional
        What is swept, as :func:`iva.sampling.points_of` returns it.

    Examples
    --------
    Lengths without a unit are not doubted:

    >>> warn_of_doubts({"absorber.gap": 4.0, "start.displacement": 0.004})
    """
    # Most scenes without units are not looked at, for the look takes longer than a short run.
    if points is None and not ("structure" in spec or "primary.mass" in spec or lasts(spec)):
        return
    for doubt in _iva.doubts(spec, points):
        import warnings

        warnings.warn(doubt, stacklevel=4)


def lasts(spec: Spec) -> bool:
    """Return whether something is known of how long a contact lasts.

    Examples
    --------
    >>> lasts({"absorber.contact_time": 1e-3})
    True
    """
    return any(name.endswith(CONTACTS) for name in spec)
