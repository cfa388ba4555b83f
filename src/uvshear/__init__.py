"""Weak-lensing galaxy shapes and shear, measured directly from interferometric visibilities.

In the order of their use:

``simulate`` lets an array observe galaxies. ``measure`` turns visibilities and a catalogue into a ``Measurement``: shapes,
and statistics for estimators of the shear; ``read_measurement`` reads one from its files. ``estimate_shear`` turns a
measurement into a shear, and ``estimate_bias`` tells how far an estimator is from the truth, on simulated galaxies.

What is measured comes from ``open_observation`` and ``read_catalogue``, or is given as paths. How it is measured is said
by a ``Model`` (profile, priors, primary beam), a ``Method`` (the extraction and its tolerances, baselines, weightings)
and ``Resources`` (an executor, memory).

Profiles, priors, estimators, extractions, executors, readers and primary beams may be objects of your own: derive them
from ``Profile``, ``EllipticityPrior``, ``SizeModel``, ``Estimator``, ``Extraction``, ``Executor``, ``Reader`` and
``Attenuation``.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

__version__ = "0.2.0.dev0"

if TYPE_CHECKING:
    from uvshear.bias import Bias, Survey, estimate_bias
    from uvshear.errors import DataWarning, InputError
    from uvshear.estimators import (
        Bayesian,
        Estimator,
        Mean,
        Metacal,
        Moments,
        Sample,
        ShearEstimate,
        Terms,
        UnlensedPopulation,
    )
    from uvshear.execution import Executor, Processes, Resources, Serial, Threads
    from uvshear.extraction import (
        ConvergedExtraction,
        Extraction,
        Method,
        Model,
        PaperExtraction,
    )
    from uvshear.galaxy import (
        CatalogueSize,
        DiscBulge,
        DiscEllipticityPrior,
        EllipticityPrior,
        Exponential,
        FlatEllipticityPrior,
        Galaxies,
        Gaussian,
        PowerLawFlux,
        Profile,
        Sersic,
        SizeFluxRelation,
        SizeModel,
    )
    from uvshear.geometry.directions import PhaseCentre
    from uvshear.interferometer import (
        Attenuation,
        Channels,
        ObservingPlan,
        Track,
        UvRange,
        Visibilities,
        VisibilitySet,
        load_layout,
    )
    from uvshear.io.bias_records import read_correction
    from uvshear.io.catalogue import Catalogue, read_catalogue, write_catalogue
    from uvshear.io.measurement_set_writer import write_measurement_set
    from uvshear.io.observations import open_observation
    from uvshear.io.readers import Reader
    from uvshear.pipeline.measure import measure
    from uvshear.pipeline.measurement import Measurement, read_measurement
    from uvshear.pipeline.shear import estimate_shear
    from uvshear.pipeline.simulate import simulate
    from uvshear.shapes.source_facet import Column, SourceFacet
    from uvshear.simulation.noise_level import GalaxyNoise

_HOMES = {
    "bias": ("Bias", "Survey", "estimate_bias"),
    "errors": ("DataWarning", "InputError"),
    "estimators": (
        "Bayesian",
        "Estimator",
        "Mean",
        "Metacal",
        "Moments",
        "Sample",
        "ShearEstimate",
        "Terms",
        "UnlensedPopulation",
    ),
    "execution": ("Executor", "Processes", "Resources", "Serial", "Threads"),
    "extraction": ("ConvergedExtraction", "Extraction", "Method", "Model", "PaperExtraction"),
    "galaxy": (
        "CatalogueSize",
        "DiscBulge",
        "DiscEllipticityPrior",
        "EllipticityPrior",
        "Exponential",
        "FlatEllipticityPrior",
        "Galaxies",
        "Gaussian",
        "PowerLawFlux",
        "Profile",
        "Sersic",
        "SizeFluxRelation",
        "SizeModel",
    ),
    "geometry.directions": ("PhaseCentre",),
    "interferometer": (
        "Attenuation",
        "Channels",
        "ObservingPlan",
        "Track",
        "UvRange",
        "Visibilities",
        "VisibilitySet",
        "load_layout",
    ),
    "io.bias_records": ("read_correction",),
    "io.catalogue": ("Catalogue", "read_catalogue", "write_catalogue"),
    "io.measurement_set_writer": ("write_measurement_set",),
    "io.observations": ("open_observation",),
    "io.readers": ("Reader",),
    "pipeline.measure": ("measure",),
    "pipeline.measurement": ("Measurement", "read_measurement"),
    "pipeline.shear": ("estimate_shear",),
    "pipeline.simulate": ("simulate",),
    "shapes.source_facet": ("Column", "SourceFacet"),
    "simulation.noise_level": ("GalaxyNoise",),
}
"""Public names by the module that has them: each is imported when it is first asked for, so that help is instant."""

_MODULE_OF = {name: module for module, names in _HOMES.items() for name in names}

__all__ = [
    "Attenuation",
    "Bayesian",
    "Bias",
    "Catalogue",
    "CatalogueSize",
    "Channels",
    "Column",
    "ConvergedExtraction",
    "DataWarning",
    "DiscBulge",
    "DiscEllipticityPrior",
    "EllipticityPrior",
    "Estimator",
    "Executor",
    "Exponential",
    "Extraction",
    "FlatEllipticityPrior",
    "Galaxies",
    "GalaxyNoise",
    "Gaussian",
    "InputError",
    "Mean",
    "Measurement",
    "Metacal",
    "Method",
    "Model",
    "Moments",
    "ObservingPlan",
    "PaperExtraction",
    "PhaseCentre",
    "PowerLawFlux",
    "Processes",
    "Profile",
    "Reader",
    "Resources",
    "Sample",
    "Serial",
    "Sersic",
    "ShearEstimate",
    "SizeFluxRelation",
    "SizeModel",
    "SourceFacet",
    "Survey",
    "Terms",
    "Threads",
    "Track",
    "UnlensedPopulation",
    "UvRange",
    "Visibilities",
    "VisibilitySet",
    "__version__",
    "estimate_bias",
    "estimate_shear",
    "load_layout",
    "measure",
    "open_observation",
    "read_catalogue",
    "read_correction",
    "read_measurement",
    "simulate",
    "write_catalogue",
    "write_measurement_set",
]


def __getattr__(name: str) -> Any:
    """Import a public name when it is first asked for."""
    if name in _MODULE_OF:
        found = getattr(import_module(f"uvshear.{_MODULE_OF[name]}"), name)
        globals()[name] = found
        return found
    raise AttributeError(f"module 'uvshear' has no attribute '{name}'")


def __dir__() -> list[str]:
    return sorted({*globals(), *_MODULE_OF})
