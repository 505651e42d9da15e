"""Sweeps of one grid by other integrators, each in a file with the same interface.

A sweep takes a grid and the numbers of its points, and returns the impacts of each, or
:data:`~.grid.UNFINISHED` where a run stopped before its end.
"""
