"""How well the sky model of a measurement has converged, in words."""

from collections.abc import Mapping

from uvshear.cli.terminal import say, warn

RELEASED = 0.5
"""Change of the sky fitted without priors, in units of the noise, above which the user is warned."""


def tell_convergence(record: Mapping[str, object]) -> None:
    """Print how well the sky has converged, if the extraction iterates."""
    left, tolerance = record.get("left_undone"), record.get("tolerance")
    if not isinstance(left, float) or not isinstance(tolerance, float):
        return
    say(
        f"{record['major_cycles']} major cycles; one more would change the model of a source by {left:.2g} times"
        f" the noise (rms over all sources), and by at most {record['left_undone_most']:.2g} times the noise for any"
        " single source"
    )
    if left > tolerance:
        warn(
            f"the sky model has not converged: one more major cycle would change it by {left:.2g} times the noise,"
            f" which is above the tolerance of {tolerance:g}; treat the shapes of overlapping galaxies with care"
        )
    released = record.get("released")
    if isinstance(released, list) and released[-1] > RELEASED:
        warn(
            "the statistics of --keep are computed from a second sky model, fitted with a wider prior on ellipticities;"
            f" this model still changed by {released[-1]:.2g} times the noise (rms) in its last cycle, so treat shears"
            " from these statistics with care"
        )
