"""Stores of Measurement Set version 4 (MSv4): opened, inspected.

A store is a directory in the zarr format. Each of its groups of visibilities, which this package calls partitions, has
one spectral window on a grid of times and baselines, and subgroups for its antennas and fields. The schema is that of
xradio (https://xradio.readthedocs.io, version 4 of ``xradio.measurement_set.schema``).
"""
