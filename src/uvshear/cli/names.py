"""What more than one command calls by the same names."""

from enum import StrEnum


class EstimatorName(StrEnum):
    """An estimator of the shear."""

    MEAN = "mean"
    MOMENTS = "moments"
    BAYESIAN = "bayesian"
    METACAL = "metacal"


class FacetName(StrEnum):
    """How visibilities become facets."""

    EXACT = "exact"
    CELL_AVERAGE = "cell-average"
