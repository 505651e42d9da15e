"""What an identification needs beyond the package itself."""

from __future__ import annotations

from typing import Any


def sampler() -> Any:
    """Return dynesty, which brings SciPy.

    Raises
    ------
    ImportError
        If it is not installed.
    """
    try:
        import dynesty
    except ImportError as error:
        raise ImportError(
            'iva.identify needs dynesty; pip install "iva-dynamics[fit]" brings it'
        ) from error
    return dynesty


__all__ = ["sampler"]
