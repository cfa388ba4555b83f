"""Readers and writers: all data that enter or leave the package are checked and converted here.

``catalogue`` and ``shapes`` define the tables that users see. ``observations`` opens visibilities with the reader of
their format from ``readers``; ``measurement_set`` reads Measurement Sets, and writes simulated ones; ``msv4`` reads
stores of version 4. ``columns`` checks the columns of a table, ``tables`` knows its formats, ``provenance`` records the
command that made a file, and ``outputs`` writes files completely or not at all.
"""
