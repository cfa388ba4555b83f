"""Extractions of small fields, above all of two galaxies that touch, without noise: errors of one show in the other."""

from dataclasses import replace

import numpy as np
from astropy.table import Table

from tests.skies import galaxies, vla
from uvshear.constants import ARCSEC
from uvshear.execution import SERIAL, Resources
from uvshear.extraction import Extracted, Extraction, Field, MeasurementOptions, Method, Model
from uvshear.galaxy import CatalogueSize
from uvshear.interferometer.summary import summarise
from uvshear.interferometer.visibilities import Observation, Visibilities, VisibilitySet
from uvshear.io.catalogue import Catalogue, catalogue_from_galaxies
from uvshear.pipeline.field import field_of_catalogue
from uvshear.predict import predict_visibilities
from uvshear.shapes.measurement import ShapeMeasurement

FREQUENCY = np.array([1.4e9])
SIZES = np.array([2.2, 2.0]) * ARCSEC
OPTIONS = MeasurementOptions(Model(size=CatalogueSize()), resources=Resources(SERIAL))
BRIGHT, FAINT = 0, 1


def pair():
    """Observation, catalogue and truth; weights are those of an SNR of some hundreds."""
    uvw, centre = vla("b", samples=4)
    truth = galaxies(
        np.array([0.0, 12.0]) * ARCSEC,
        np.array([0.0, 5.0]) * ARCSEC,
        np.array([2e-3, 1.5e-3]),
        SIZES,
        np.array([0.4 + 0.2j, -0.3 + 0.3j]),
    )
    vis = predict_visibilities(truth, uvw, FREQUENCY)
    block = Visibilities(uvw, FREQUENCY, vis, np.full(vis.shape, 1e8))
    return VisibilitySet(centre, (block,)), catalogue_from_galaxies(truth, centre), truth


def with_extraction(extraction: Extraction) -> MeasurementOptions:
    """Return the options of these tests with another way of telling sources apart."""
    return replace(OPTIONS, method=Method(extraction))


def field_of(
    observation: Observation, catalogue: Catalogue, options: MeasurementOptions = OPTIONS
) -> Field:
    """Return the field of a catalogue, as a measurement has it."""
    summary, centre = summarise(observation), observation.phase_centre
    return field_of_catalogue(catalogue, centre, summary, options.model, options.method)


def extract(
    observation: Observation,
    catalogue: Catalogue,
    options: MeasurementOptions = OPTIONS,
    progress=None,
) -> Extracted:
    """Extract the sources of a catalogue."""
    field = field_of(observation, catalogue, options)
    return options.method.extraction.extract(observation, field, options.setting, progress)


def measure(
    observation: Observation, catalogue: Catalogue, options: MeasurementOptions = OPTIONS
) -> Table:
    """Extract the sources of a catalogue; return their shapes, one row a source, and the record."""
    flags = field_of(observation, catalogue, options).flags
    extracted = extract(observation, catalogue, options)
    shapes = [
        extracted.measurements.get(source, ShapeMeasurement.failed(flag))
        for source, flag in enumerate(flags)
    ]
    covariance = np.array([shape.covariance for shape in shapes])
    columns = {
        "e1": [shape.ellipticity[0] for shape in shapes],
        "e2": [shape.ellipticity[1] for shape in shapes],
        "e1_err": np.sqrt(covariance[:, 0, 0]),
        "e2_err": np.sqrt(covariance[:, 1, 1]),
        "flux_fit": [shape.flux for shape in shapes],
        "flux_fit_err": [shape.flux_err for shape in shapes],
        "dl": [shape.offset[0] for shape in shapes],
        "snr": [shape.snr for shape in shapes],
        "flag": [shape.flag.word for shape in shapes],
    }
    return Table(columns, meta=dict(extracted.record))
