"""Studies to run and to copy: the questions of the paper, forced response, earthquake and others.

The same files come with the command, as ``iva examples``. Each study says at its top what it asks.

Examples
--------
>>> iva.examples.names()[:3]
('decay.csv', 'earthquake.toml', 'floor_upright.toml')
"""

from __future__ import annotations

import os

from iva import _iva
from iva.parameters import shown
from iva.spelling import spell_checked

TYPE_CHECKING = False  # as in iva/__init__.py
if TYPE_CHECKING:
    from pathlib import Path

__all__ = ["copy", "names"]


def names() -> tuple[str, ...]:
    """Return the names of all files: studies (TOML), an earthquake (AT2) and a decay (CSV).

    Returns
    -------
    tuple of str
        In the order of the alphabet.

    Examples
    --------
    >>> len(iva.examples.names())
    14
    """
    return tuple(_iva.example_names())


@spell_checked
def copy(folder: str | os.PathLike[str] = "studies") -> list[Path]:
    """Copy all files into a folder.

    Parameters
    ----------
    folder : str or path, default "studies"
        The folder, which is made if it is not there.

    Returns
    -------
    list of Path
        The files that were written; those that were there already are left as they are.

    Raises
    ------
    TypeError
        If `folder` is no path.
    ValueError
        If the folder has a file of one of these names with other contents; nothing is written then.
    iva.IvaError
        If a file cannot be read or written.

    Examples
    --------
    >>> iva.examples.copy("my studies")  # doctest: +SKIP
    """
    if not isinstance(folder, str | os.PathLike):
        raise TypeError(f"folder = {shown(folder)}: give a path")
    return _iva.copy_examples(folder)
