"""A warning where a length was given in metres that was meant in millimetres."""

from __future__ import annotations

from iva import _iva

TYPE_CHECKING = False  # as in iva/__init__.py
if TYPE_CHECKING:
    from typing import Any

    from iva.parameters import Spec


def warn_of_metres(spec: Spec, points: tuple[Any, ...] | None = None) -> None:
    """Warn of lengths of a scene in SI units that seem to be meant in millimetres.

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

    >>> warn_of_metres({"absorber.gap": 4.0, "start.displacement": 0.004})
    """
    # Most scenes without units are not looked at, for the look takes longer than a short run.
    if points is None and "structure" not in spec and "primary.mass" not in spec:
        return
    for doubt in _iva.doubts(spec, points):
        import warnings

        warnings.warn(doubt, stacklevel=4)
