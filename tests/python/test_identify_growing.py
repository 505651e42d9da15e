"""When a larger window of a pendulum's record fits worse than chance."""

from __future__ import annotations

import numpy as np
import pytest

pytest.importorskip("dynesty")

from iva.identification.shooting import Shot, worse
from iva.identification.swings import HEAD, Swing


def window(samples: int, misfit: float) -> Shot:
    """Return a window of three impacts of which only size and misfit matter."""
    none = np.zeros(0)
    return Shot(np.zeros(HEAD), np.full(3, 0.5), Swing(np.zeros(samples)), misfit, none, none, 0.0)


@pytest.mark.parametrize("noise", [0.7, 1.0, 1.4])  # the estimate may be off
def test_a_window_that_passes_over_an_impact_fits_worse(noise: float) -> None:
    best = window(600, 0.98 * noise)
    assert not worse(best, window(1200, 0.99 * noise))
    assert worse(best, window(1200, 1.12 * noise))
    # Of few samples more χ² may be chance.
    assert not worse(best, window(610, 0.99 * noise))
    assert not worse(best, window(600, 1.5 * noise))
