"""What a record leaves undetermined, in words."""

from __future__ import annotations

from itertools import combinations

import numpy as np

from iva.identification.responses import Values

#: Relative standard deviation beyond which the record alone says too little along a direction.
LOOSE = 0.2
#: Largest share of a null direction that may fall on numbers that it is not said to hold.
STRAY = 0.1


def null_directions(information: Values) -> Values:
    """Return directions along which a record says next to nothing, one a column, sparse.

    Parameters
    ----------
    information : ndarray, shape (n, n)
        Of the record alone, about relative changes of n numbers.

    Returns
    -------
    ndarray, shape (n, k)
        Each of length 1 and on as few of the numbers as possible.
    """
    size = information.shape[0]
    values, vectors = np.linalg.eigh(information)
    space = vectors[:, values < LOOSE**-2]
    found: list[Values] = []
    for many in range(1, size + 1):
        for chosen in combinations(range(size), many):
            if len(found) == space.shape[1]:
                return np.array(found).T.reshape(size, len(found))
            others = [row for row in range(size) if row not in chosen]
            strays = space[others].T @ space[others]
            share, axes = np.linalg.eigh(strays)
            if share[0] > STRAY**2:
                continue
            direction = space @ axes[:, 0]
            before = np.array(found).T.reshape(size, len(found))
            if np.linalg.matrix_rank(np.column_stack([before, direction]), tol=0.2) > len(found):
                found.append(direction)
    return np.array(found).T.reshape(size, len(found))


def in_words(direction: Values, names: tuple[str, ...]) -> str:
    """Return what a null direction means.

    Parameters
    ----------
    direction : ndarray, shape (n,)
        One column of :func:`null_directions`.
    names : tuple of str
        Names of the n numbers, from ``mass_ratio``, ``gap``, ``rest position``, ``restitution``
        and others.
    """
    held = [index for index in range(len(names)) if abs(direction[index]) > STRAY]
    chosen = [names[index] for index in held]
    if len(held) == 1:
        return f"{chosen[0]} is not determined"
    if set(chosen) == {"gap", "rest position"}:
        same = direction[held[0]] * direction[held[1]] > 0
        return f"only clearance {'−' if same else '+'} rest position is determined"
    if set(chosen) == {"mass_ratio", "restitution"}:
        return "only mass_ratio (1 + restitution) / (1 + mass_ratio) is determined"
    parts = ", ".join(
        f"{names[index]} by {direction[index] / np.max(np.abs(direction)):+.2g}" for index in held
    )
    return f"{' and '.join(chosen)} are not determined apart: they may change together, {parts}"


__all__ = ["in_words", "null_directions"]
