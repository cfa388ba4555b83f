"""The field of an extraction from a catalogue: priors, an initial sky, and flags of sources that cannot be measured."""

from dataclasses import replace

import numpy as np
from scipy.spatial import cKDTree

from uvshear.constants import REFERENCE_FREQUENCY
from uvshear.errors import InputError
from uvshear.extraction import Field, Method, Model
from uvshear.galaxy import Galaxies, SizeFluxRelation
from uvshear.geometry.directions import PhaseCentre
from uvshear.interferometer.summary import ObservationSummary
from uvshear.io.catalogue import Catalogue
from uvshear.predict.response import FAINTEST, Response
from uvshear.shapes.measurement import FitFlag
from uvshear.typing import Array, Bool, Float, Int

STEEPEST_CREDIBLE = 4.0
"""Spectral index, of either sign, with which fluxes are extrapolated to 1.4 GHz for the prior on the size; steeper ones
are errors of fits to few channels."""

LARGEST_CHANGE = 1e6
"""Largest ratio of a flux in the band and at the reference frequency of the catalogue, and of its inverse."""

SAME_PLACE = 0.25
"""Two sources are one if they are closer than this fraction of the smaller one's median scale length."""


def field_of_catalogue(
    sources: Catalogue,
    phase_centre: PhaseCentre,
    summary: ObservationSummary,
    model: Model,
    method: Method,
) -> Field:
    """Place the sources about a phase centre, as round galaxies of the catalogue's fluxes and of median size.

    Raises
    ------
    InputError
        No baseline of the observation is within the uv range of the method, or the spectrum of a source gives it an
        absurd flux in the band.
    """
    l, m, n = sources.directions(phase_centre)
    flags = _flags(sources, np.hypot(l, m), n, method.field_radius)
    is_modelled = (flags == FitFlag.OK) | (flags == FitFlag.POINT_SOURCE)
    is_point = flags == FitFlag.POINT_SOURCE
    _check_spectra(sources, summary)
    index = np.clip(sources.spectral_index, -STEEPEST_CREDIBLE, STEEPEST_CREDIBLE)
    flux_at_1_4 = sources.flux * (REFERENCE_FREQUENCY / sources.reference_frequency) ** index
    # A point has no size; where one is needed, as for the prior of its position, that of a galaxy of its flux serves.
    usual = np.exp(SizeFluxRelation().prior(flux_at_1_4).log_median)
    known_size = (
        None if sources.scale_length is None else np.where(is_point, usual, sources.scale_length)
    )
    errors = () if sources.scale_length_err is None else (sources.scale_length_err,)
    size = model.size.prior(flux_at_1_4, known_size, *errors)
    repeated = _repeated(l, m, sources.flux, np.exp(size.log_median), is_modelled)
    flags[repeated] = FitFlag.DUPLICATE
    is_modelled[repeated] = False
    sky = Galaxies(
        l=np.where(is_modelled, l, 0.0),
        m=np.where(is_modelled, m, 0.0),
        flux=np.where(is_modelled, sources.flux, 0.0),
        scale_length=np.where(is_point, 0.0, np.exp(size.log_median)),
        ellipticity=np.zeros(len(sources), complex),
        spectral_index=sources.spectral_index,
        reference_frequency=sources.reference_frequency,
    )
    # Sources of which averaging and primary beams leave next to nothing cannot be modelled.
    members = np.flatnonzero(is_modelled)
    there = sky.select(members)
    response = Response.from_sky(there, summary.probes, model.attenuation(phase_centre.dec))
    unseen = members[response.attenuations(there) < FAINTEST]
    flags[unseen] = FitFlag.OUTSIDE_FIELD
    is_modelled[unseen] = False
    sky = replace(sky, flux=np.where(is_modelled, sky.flux, 0.0))
    if method.uv_range.minimum >= summary.longest:
        raise InputError(
            f"--uv-min {method.uv_range.minimum:g} (uv_range=): the longest baseline of the observation is"
            f" {summary.longest:.4g} wavelengths; a lower --uv-min is needed"
        )
    longest = min(method.uv_range.maximum, summary.longest)
    unknown = np.zeros(len(sources))
    return Field(
        l,
        m,
        sky,
        size,
        np.flatnonzero(is_modelled),
        flags,
        replace(method.uv_range, maximum=longest),
        summary,
        flux_err=unknown if sources.flux_err is None else sources.flux_err,
        position_err=unknown if sources.position_err is None else sources.position_err,
        weight_correction=np.ones(len(sources)),
    )


def _check_spectra(sources: Catalogue, summary: ObservationSummary) -> None:
    """Refuse spectra that change the flux by more than ``LARGEST_CHANGE`` between their reference and the band."""
    if len(sources) == 0:
        return
    farthest = max(
        (summary.lowest_frequency, summary.frequency),
        key=lambda frequency: abs(np.log(frequency / sources.reference_frequency)),
    )
    if len(sources) == 0:
        return
    exponent = sources.spectral_index * np.log10(farthest / sources.reference_frequency)
    worst = int(np.argmax(np.abs(exponent)))
    if abs(exponent[worst]) > np.log10(LARGEST_CHANGE):
        raise InputError(
            f"source id {sources.identifier[worst]}: with the spectral index {sources.spectral_index[worst]:.4g}, its"
            f" flux at {farthest:.4g} Hz is 1e{exponent[worst]:.0f} times the flux at the reference frequency of"
            f" {sources.reference_frequency:.4g} Hz; a credible spectral index and reference frequency are needed"
        )


def _flags(
    sources: Catalogue,
    distance: Float[Array, " source"],
    n: Float[Array, " source"],
    field_radius: float,
) -> Array:
    flags = np.full(len(sources), FitFlag.OK, dtype=object)
    if sources.scale_length is not None:
        flags[sources.scale_length == 0] = FitFlag.POINT_SOURCE
    flags[distance > np.sin(field_radius)] = FitFlag.OUTSIDE_FIELD
    flags[n <= 0] = FitFlag.BELOW_HORIZON
    if sources.is_point is not None:
        flags[sources.is_point & (flags == FitFlag.OK)] = FitFlag.POINT_SOURCE
    return flags


def _repeated(
    l: Float[Array, " source"],
    m: Float[Array, " source"],
    flux: Float[Array, " source"],
    scale_length: Float[Array, " source"],
    is_modelled: Bool[Array, " source"],
) -> Int[Array, " repeated"]:
    """Find the fainter of sources at one place; of equals, those that come later."""
    members = np.flatnonzero(is_modelled)
    place, size = np.column_stack([l, m])[members], scale_length[members]
    if len(members) == 0:
        return members
    pairs = cKDTree(place).query_pairs(SAME_PLACE * float(size.max()), output_type="ndarray")
    apart = np.hypot(*(place[pairs[:, 0]] - place[pairs[:, 1]]).T)
    pairs = pairs[apart < SAME_PLACE * np.minimum(size[pairs[:, 0]], size[pairs[:, 1]])]
    first, second = members[pairs.min(axis=1)], members[pairs.max(axis=1)]
    return np.unique(np.where(flux[first] >= flux[second], second, first))
