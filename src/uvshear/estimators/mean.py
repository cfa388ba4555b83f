"""Shear as the weighted mean of ellipticities, the estimator of Rivi & Miller 2018."""

from dataclasses import dataclass

import numpy as np

from uvshear.estimators.estimator import Estimator
from uvshear.estimators.sample import Sample
from uvshear.estimators.terms import Terms
from uvshear.typing import Array, Complex


@dataclass(frozen=True)
class Mean(Estimator):
    r"""Mean of the posterior-mean ellipticities, weighted by lensfit's weight.

    .. math:: g = \frac{\sum w e}{\sum w}

    Noise biases the mean: m is about -0.1 at signal-to-noise ratios of 10 and more (Rivi & Miller 2018, Table 2).

    """

    name = "mean"
    shape_columns = ("e1", "e2", "weight")
    remark = (
        "noise biases the mean of ellipticities: the shear is about 10 per cent too small for galaxies"
        " with signal-to-noise ratios of 10 or more; `--estimator moments` and `--estimator bayesian`"
        " have no such bias"
    )

    def terms(self, sample: Sample, about: Complex[Array, " source"]) -> Terms:
        """Return ellipticity times weight, and the weight."""
        weight = np.asarray(sample["weight"], float)
        e = np.stack([sample["e1"], sample["e2"]], axis=-1)
        return Terms(e, np.broadcast_to(np.eye(2), (len(sample), 2, 2))).weighted(weight)
