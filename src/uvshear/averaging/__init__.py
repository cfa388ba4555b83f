"""Averages of visibilities over cells of (u, v, w): fewer rows with nearly all of the information.

``cells`` chooses the sizes of the cells for the width of a field. ``cell_table`` holds the sums over the samples of
each cell, and ``nodes`` turns them into one to four rows. ``averager`` averages an observation in one pass, and
``in_partitions`` divides it into ranges of rows.
"""
