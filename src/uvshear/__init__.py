"""Weak-lensing galaxy shapes and shear, measured directly from interferometric visibilities.

Each command of the command line is a function that takes paths, tables or objects:

>>> m = uvshear.measure("FIELD.ms", "CAT.fits", keep="moments")
>>> m.write("SHAPES.fits")
>>> print(uvshear.estimate_shear(m, "moments"))

Quantities are in SI units, radians and jansky. Shears are in the frame of local North (TreeCorr's
convention for RA and Dec).

Measure
    ``measure`` turns visibilities and a catalogue into a ``Measurement``, which ``read_measurement`` reads back from
    its files. ``FitFlag`` lists the flags of sources. ``DataWarning`` is issued for problems in the data, and
    ``InputError`` is raised for wrong inputs. A ``Checkpoint`` is a directory for the state of a measurement, from
    which another run can go on.
Visibilities
    ``open_observation`` opens the part of files that a ``Reading`` selects, ``inspect`` summarises a file, and
    ``scaled_to_its_noise`` takes the noise from the scatter of the data. ``average`` writes a Measurement Set of the
    averages of an observation over cells of (u, v, w), which is measured like any other. ``VisibilitySet`` holds
    ``Visibilities`` in memory about a ``PhaseCentre``.
Catalogues
    ``read_catalogue`` and ``write_catalogue`` read and write the file of a ``Catalogue``; ``catalogue_from_galaxies``
    makes one of simulated galaxies.
Assumptions: ``Model``
    Profiles are ``Exponential``, ``Gaussian``, ``Sersic`` and ``DiscBulge``. Sizes come from ``SizeFluxRelation`` or
    ``CatalogueSize``. Priors on the ellipticity are ``FlatEllipticityPrior`` and ``DiscEllipticityPrior``. Primary
    beams are ``AiryBeam``, ``CosineCubedBeam`` and ``CosineTaperBeam``.
Algorithm: ``Method``
    ``ConvergedExtraction`` or ``PaperExtraction``, a ``UvRange``, and weightings: ``Uniform``, ``Briggs``,
    ``GaussianTaper``, ``TukeyTaper`` and ``RoundPsf``.
Cores and memory: ``Resources``
    The executor is ``Serial``, ``Copies``, ``Threads``, ``Processes`` or ``Dask``.
Progress
    The argument ``progress`` of long work takes a function, or an ``Observer`` that is told of each ``Stage``; a
    ``Course`` is an observer that knows the time that is left.
Shear
    ``estimate_shear`` returns a ``ShearEstimate``, for which it uses ``Mean``, ``Moments``, ``Bayesian`` or
    ``Metacal``; ``write_shear`` writes the estimate to a file.
    ``read_population`` reads an ``UnlensedPopulation`` that Bayesian estimates assume. ``fit_slopes`` compares
    measured with true ellipticities.
Bias
    ``estimate_bias`` measures the ``Bias`` of an estimator on simulated galaxies of a ``Survey``; ``estimate_shear``
    can remove it from a shear. ``write_bias`` and ``read_bias`` write and read its file.
The paper
    ``reproduce_paper`` reproduces tables and figures of Rivi & Miller 2018, and compares them with the paper.
Simulate
    ``simulate`` simulates an observation of the sources of a catalogue according to an ``ObservingPlan``
    (``known_layouts``, ``load_layout``, ``Track``, ``Channels``), with noise from ``GalaxyNoise``, ``StokesINoise``,
    ``CorrelationNoise`` or ``ScaledNoise``; ``write_measurement_set`` writes the observation. ``draw_population`` draws
    ``Galaxies`` of a ``Population`` (``PowerLawFlux``) in a ``SquareField`` or a ``DiscField``, and ``expected_number``
    gives their number. ``shear_galaxies`` applies a lens, and ``shear_at_fixed_scale_length`` the shear of the
    simulations of Rivi & Miller 2018.
Images and the PSF
    ``point_spread_function`` images the weights of an observation on an ``ImageGrid``; ``measure_psf`` and
    ``fit_main_lobe`` measure it. ``weighted`` applies weightings, and ``weighting_loss`` computes the loss of
    information. ``write_residual_image`` writes the result of ``Measurement.residual_image``. The functions in
    ``plot`` draw the figures.
Objects of your own
    Derive them from ``Profile``, ``SizeModel``, ``EllipticityPrior``, ``PrimaryBeam``, ``Attenuation``, ``Noise``,
    ``Weighting``, ``Extraction``, ``Executor``, ``Reader`` or ``Estimator``. An estimator keeps a ``Column`` for
    each number that it takes from a ``SourceFacet``, and turns a ``Sample`` into ``Terms``.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

__version__ = "0.2.0.dev0"

if TYPE_CHECKING:
    from uvshear import plot
    from uvshear.bias import Survey, estimate_bias
    from uvshear.diagnostics.psf import point_spread_function
    from uvshear.diagnostics.slope import fit_slopes
    from uvshear.diagnostics.weighting_loss import weighting_loss
    from uvshear.errors import DataWarning, InputError
    from uvshear.estimators import (
        Bayesian,
        Bias,
        Estimator,
        Mean,
        Metacal,
        Moments,
        Sample,
        ShearEstimate,
        Terms,
        UnlensedPopulation,
    )
    from uvshear.execution import (
        Copies,
        Dask,
        Executor,
        Processes,
        Resources,
        Serial,
        Threads,
    )
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
    from uvshear.imaging import ImageGrid
    from uvshear.interferometer import (
        Attenuation,
        Channels,
        ObservingPlan,
        Track,
        UvRange,
        Visibilities,
        VisibilitySet,
        known_layouts,
        load_layout,
    )
    from uvshear.interferometer.noise import CorrelationNoise, Noise, ScaledNoise, StokesINoise
    from uvshear.interferometer.primary_beam import (
        AiryBeam,
        CosineCubedBeam,
        CosineTaperBeam,
        PrimaryBeam,
    )
    from uvshear.interferometer.psf_shape import fit_main_lobe, measure_psf
    from uvshear.interferometer.scaled_observation import scaled_to_its_noise
    from uvshear.interferometer.weighting import (
        Briggs,
        GaussianTaper,
        RoundPsf,
        TukeyTaper,
        Uniform,
        Weighting,
        weighted,
    )
    from uvshear.io.bias_records import read_bias, write_bias
    from uvshear.io.catalogue import (
        Catalogue,
        catalogue_from_galaxies,
        read_catalogue,
        write_catalogue,
    )
    from uvshear.io.checkpoint import Checkpoint
    from uvshear.io.images import write_residual_image
    from uvshear.io.measurement_set.writer import write_measurement_set
    from uvshear.io.observations import inspect, open_observation
    from uvshear.io.population import read_population
    from uvshear.io.readers import Reader
    from uvshear.io.reading import Reading
    from uvshear.io.shear_records import write_shear
    from uvshear.pipeline.average import average
    from uvshear.pipeline.measure import measure
    from uvshear.pipeline.measurement import Measurement, read_measurement
    from uvshear.pipeline.shear import estimate_shear
    from uvshear.pipeline.simulate import simulate
    from uvshear.progress import Course, Observer, Stage
    from uvshear.reproduce.run import reproduce_paper
    from uvshear.shapes.measurement import FitFlag
    from uvshear.shapes.source_facet import Column, SourceFacet
    from uvshear.simulation.lensing import shear_at_fixed_scale_length, shear_galaxies
    from uvshear.simulation.noise_level import GalaxyNoise
    from uvshear.simulation.population import Population, draw_population, expected_number
    from uvshear.simulation.sky_region import DiscField, SquareField

_HOMES = {
    "bias": "Survey estimate_bias",
    "diagnostics.psf": "point_spread_function",
    "diagnostics.slope": "fit_slopes",
    "diagnostics.weighting_loss": "weighting_loss",
    "errors": "DataWarning InputError",
    "estimators": (
        "Bayesian Bias Estimator Mean Metacal Moments Sample ShearEstimate Terms UnlensedPopulation"
    ),
    "execution": "Copies Dask Executor Processes Resources Serial Threads",
    "extraction": "ConvergedExtraction Extraction Method Model PaperExtraction",
    "galaxy": (
        "CatalogueSize DiscBulge DiscEllipticityPrior EllipticityPrior Exponential "
        "FlatEllipticityPrior Galaxies Gaussian PowerLawFlux Profile Sersic SizeFluxRelation "
        "SizeModel"
    ),
    "geometry.directions": "PhaseCentre",
    "imaging": "ImageGrid",
    "interferometer": (
        "Attenuation Channels ObservingPlan Track UvRange Visibilities VisibilitySet "
        "known_layouts load_layout"
    ),
    "interferometer.noise": "CorrelationNoise Noise ScaledNoise StokesINoise",
    "interferometer.scaled_observation": "scaled_to_its_noise",
    "interferometer.primary_beam": "AiryBeam CosineCubedBeam CosineTaperBeam PrimaryBeam",
    "interferometer.psf_shape": "fit_main_lobe measure_psf",
    "interferometer.weighting": (
        "Briggs GaussianTaper RoundPsf TukeyTaper Uniform Weighting weighted"
    ),
    "io.bias_records": "read_bias write_bias",
    "io.checkpoint": "Checkpoint",
    "io.catalogue": "Catalogue catalogue_from_galaxies read_catalogue write_catalogue",
    "io.images": "write_residual_image",
    "io.measurement_set.writer": "write_measurement_set",
    "io.observations": "inspect open_observation",
    "io.population": "read_population",
    "io.readers": "Reader",
    "io.reading": "Reading",
    "io.shear_records": "write_shear",
    "pipeline.average": "average",
    "pipeline.measure": "measure",
    "pipeline.measurement": "Measurement read_measurement",
    "pipeline.shear": "estimate_shear",
    "pipeline.simulate": "simulate",
    "progress": "Course Observer Stage",
    "reproduce.run": "reproduce_paper",
    "shapes.measurement": "FitFlag",
    "shapes.source_facet": "Column SourceFacet",
    "simulation.lensing": "shear_at_fixed_scale_length shear_galaxies",
    "simulation.noise_level": "GalaxyNoise",
    "simulation.population": "Population draw_population expected_number",
    "simulation.sky_region": "DiscField SquareField",
}
"""Public names by the module that has them: each is imported when it is first asked for, so that help is instant."""

_MODULE_OF = {name: module for module, names in _HOMES.items() for name in names.split()}

__all__ = [
    "AiryBeam",
    "Attenuation",
    "Bayesian",
    "Bias",
    "Briggs",
    "Catalogue",
    "CatalogueSize",
    "Channels",
    "Checkpoint",
    "Column",
    "ConvergedExtraction",
    "Copies",
    "CorrelationNoise",
    "CosineCubedBeam",
    "CosineTaperBeam",
    "Course",
    "Dask",
    "DataWarning",
    "DiscBulge",
    "DiscEllipticityPrior",
    "DiscField",
    "EllipticityPrior",
    "Estimator",
    "Executor",
    "Exponential",
    "Extraction",
    "FitFlag",
    "FlatEllipticityPrior",
    "Galaxies",
    "GalaxyNoise",
    "Gaussian",
    "GaussianTaper",
    "ImageGrid",
    "InputError",
    "Mean",
    "Measurement",
    "Metacal",
    "Method",
    "Model",
    "Moments",
    "Noise",
    "Observer",
    "ObservingPlan",
    "PaperExtraction",
    "PhaseCentre",
    "Population",
    "PowerLawFlux",
    "PrimaryBeam",
    "Processes",
    "Profile",
    "Reader",
    "Reading",
    "Resources",
    "RoundPsf",
    "Sample",
    "ScaledNoise",
    "Serial",
    "Sersic",
    "ShearEstimate",
    "SizeFluxRelation",
    "SizeModel",
    "SourceFacet",
    "SquareField",
    "Stage",
    "StokesINoise",
    "Survey",
    "Terms",
    "Threads",
    "Track",
    "TukeyTaper",
    "Uniform",
    "UnlensedPopulation",
    "UvRange",
    "Visibilities",
    "VisibilitySet",
    "Weighting",
    "__version__",
    "average",
    "catalogue_from_galaxies",
    "draw_population",
    "estimate_bias",
    "estimate_shear",
    "expected_number",
    "fit_main_lobe",
    "fit_slopes",
    "inspect",
    "known_layouts",
    "load_layout",
    "measure",
    "measure_psf",
    "open_observation",
    "plot",
    "point_spread_function",
    "read_bias",
    "read_catalogue",
    "read_measurement",
    "read_population",
    "reproduce_paper",
    "scaled_to_its_noise",
    "shear_at_fixed_scale_length",
    "shear_galaxies",
    "simulate",
    "weighted",
    "weighting_loss",
    "write_bias",
    "write_catalogue",
    "write_measurement_set",
    "write_residual_image",
    "write_shear",
]


def __getattr__(name: str) -> Any:
    """Import a public name when it is first asked for."""
    if name == "plot":
        return import_module("uvshear.plot")
    if name in _MODULE_OF:
        found = getattr(import_module(f"uvshear.{_MODULE_OF[name]}"), name)
        globals()[name] = found
        return found
    raise AttributeError(f"module 'uvshear' has no attribute '{name}'")


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
