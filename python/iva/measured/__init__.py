"""Measured records of a structure's motion, from files of recorders or from arrays.

:meth:`Measured.read` reads text in its many dialects, accelerograms, MAT files, universal files and
those of LabVIEW; :meth:`iva.Recorded.read` reads the same files by the same readers.

A record is what the sensor showed, in SI units and at equal steps: offset, drift and hum stay in
it. Nothing is guessed: a unit that neither file nor caller states, steps that differ, and values
that are missing are refused.

Examples
--------
>>> import numpy as np
>>> time = 12.4 + np.arange(4000) / 2000
>>> record = Measured(time, 3.0 * np.exp(-time) * np.cos(50 * time), "acceleration")
>>> record
Measured(4000 samples of acceleration at 2000 Hz from 12.4 to 14.3995 s)
>>> record.sampling_hz, len(record), record.unit
(2000.0, 4000, 'm/s²')
"""

from iva.measured.records import Measured

__all__ = ["Measured"]
