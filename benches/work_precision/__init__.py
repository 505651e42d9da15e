"""Accuracy against run time: iva and general integrators on the reference scenes.

One module a tool, all with the same two names: ``SETTINGS`` and ``solve``, see :mod:`.results`.
"""
