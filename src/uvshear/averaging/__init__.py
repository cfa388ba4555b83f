"""Averages of visibilities over cells of (u, v, w), after which a set has fewer rows and nearly the same information.

``cells`` chooses the cells for the width of a field, ``cell_table`` has the sums over the samples of each cell,
``nodes`` makes a few rows of them, and ``averager`` collects them in a pass over an observation, which
``in_partitions`` divides into ranges of rows.
"""
