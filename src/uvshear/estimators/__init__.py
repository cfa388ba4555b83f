"""Estimators of the shear, one file each: the statistics of a facet that are kept, and the terms of the ratio of sums.

``estimator`` has the base class; ``mean``, ``moments``, ``bayesian`` and ``metacal`` have the estimators, which
``registry`` finds by name. ``estimate`` turns a ``Sample`` of measured or simulated sources into a ``ShearEstimate``.
"""

from uvshear.estimators.bayesian import Bayesian
from uvshear.estimators.bias import Bias
from uvshear.estimators.estimate import estimate_sample_shear
from uvshear.estimators.estimator import Estimator
from uvshear.estimators.mean import Mean
from uvshear.estimators.metacal import Metacal
from uvshear.estimators.moments import Moments
from uvshear.estimators.population import UnlensedPopulation
from uvshear.estimators.registry import ESTIMATORS, estimator_of, estimators_of
from uvshear.estimators.sample import Sample
from uvshear.estimators.shear_estimate import ShearEstimate
from uvshear.estimators.terms import Terms

__all__ = [
    "ESTIMATORS",
    "Bayesian",
    "Bias",
    "Estimator",
    "Mean",
    "Metacal",
    "Moments",
    "Sample",
    "ShearEstimate",
    "Terms",
    "UnlensedPopulation",
    "estimate_sample_shear",
    "estimator_of",
    "estimators_of",
]
