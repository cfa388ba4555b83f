"""The instrument: antennas, the baselines and channels that they sample, and the noise.

``layout`` and ``coverage`` give the baselines, ``spectral_window`` the channels and ``noise`` their noise; ``stokes``
combines correlations into Stokes I. ``visibilities`` and ``facet`` hold the containers that the rest of the package
uses. ``accumulate`` is a pass over the visibilities, and ``first_pass`` the one that comes before any measurement.
"""

from uvshear.geometry.directions import PhaseCentre
from uvshear.interferometer.attenuation import Attenuation
from uvshear.interferometer.coverage import Track, synthesise
from uvshear.interferometer.layout import ArrayLayout, known_layouts, load_layout
from uvshear.interferometer.plan import ObservingPlan
from uvshear.interferometer.spectral_window import Channels
from uvshear.interferometer.uv_range import UvRange
from uvshear.interferometer.visibilities import Observation, Visibilities, VisibilitySet

__all__ = [
    "ArrayLayout",
    "Attenuation",
    "Channels",
    "Observation",
    "ObservingPlan",
    "PhaseCentre",
    "Track",
    "UvRange",
    "Visibilities",
    "VisibilitySet",
    "known_layouts",
    "load_layout",
    "synthesise",
]
