"""A chain of three masses with proportional damping, whose modes are planted in files.

They are those of SciPy's ``eigh``.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.linalg import eigh

MASS: Any = np.diag([3.0, 2.0, 1.0])
STIFFNESS: Any = np.array([[5e4, -2e4, 0.0], [-2e4, 3e4, -1e4], [0.0, -1e4, 1e4]])
DAMPING = 2.0 * MASS + 1e-4 * STIFFNESS
SQUARES, SHAPES = eigh(STIFFNESS, MASS)
OMEGA = np.sqrt(SQUARES)
#: Of damping αM + βK: ζ = (α/ω + βω)/2.
RATIOS = (2.0 / OMEGA + 1e-4 * OMEGA) / 2.0
