"""Readers and writers: everything that enters or leaves the package is checked and converted here.

``catalogue`` and ``shapes`` hold the tables of users. ``observations`` opens visibilities, with the reader of their
format from ``readers``; ``measurement_set`` is the package's own, and ``measurement_set_writer`` writes simulations.
``columns`` checks the columns of a table, ``tables`` knows its formats, ``provenance`` records the command that made a
file, and ``outputs`` writes files completely or not at all.
"""
