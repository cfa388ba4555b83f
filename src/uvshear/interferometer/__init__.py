"""The instrument: where its antennas stand, what they sample, and how noisily.

``layout`` and ``coverage`` make baselines, ``spectral_window`` channels, ``noise`` their errors, ``stokes`` one
Stokes I out of correlations. ``visibilities`` and ``facet`` are the containers that the rest of the package
passes round.
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
