"""The instrument: where its antennas stand, what they sample, and how noisily.

``layout`` and ``coverage`` make baselines, ``spectral_window`` channels, ``noise`` their errors, ``stokes`` one
Stokes I out of correlations. ``visibilities`` and ``facet`` are the containers that the rest of the package
passes round.
"""
