"""Errors about files, as one line that a terminal shows and does not obey."""

from __future__ import annotations

from iva import _iva


def fault(message: str) -> _iva.IvaError:
    r"""Return the error with a message; control characters in it, as of a file's name, are escaped.

    Examples
    --------
    >>> print(fault("results/\x1b[31m is missing"))
    results/\u{1b}[31m is missing
    """
    return _iva.IvaError(_iva.visible(message))
