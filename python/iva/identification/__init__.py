"""Parameters of a structure and its absorber from measured decays.

:func:`identify` takes a record and gives a :class:`Fit`.
"""

from iva.identification.fits import Fit
from iva.identification.identifying import identify

__all__ = ["Fit", "identify"]
