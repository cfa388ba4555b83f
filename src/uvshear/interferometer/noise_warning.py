"""The warning about weights that do not agree with the noise."""

from uvshear.interferometer.noise_estimate import NoiseEstimate

REMEDY = (
    "unless the weights are corrected, or the noise is taken from the data (--noise data, or"
    " uvshear.scaled_to_its_noise in Python)"
)


def noise_warning(name: str, noise: NoiseEstimate | None) -> str | None:
    """Return the warning about the weights of a set, or that they cannot be judged; None where they are right.

    Parameters
    ----------
    name
        Name of the set, for the message.
    noise
        Estimate of its noise; None where there are too few samples, about which nothing is said.
    """
    if noise is None:
        return None
    ratio, origin = noise.ratio, noise.smallest.origin
    if noise.is_certain and not noise.is_near():
        return (
            f"{name}: the noise is {ratio:.3g} times what the weights claim, judging by {origin}; all errors are wrong"
            f" by this factor {REMEDY}"
        )
    if noise.is_below():
        return (
            f"{name}: the noise is at most {ratio:.3g} times what the weights claim, judging by {origin}, to which"
            f" sources may still contribute; all errors are too large, by at least the inverse of this factor, {REMEDY}"
        )
    if noise.exceeds() and noise.contradicting is not None:
        other = noise.contradicting
        return (
            f"{name}: whether the weights agree with the noise cannot be told, because sources that are not in the"
            f" catalogue or were not fitted contribute to the residual: judging by {origin}, the noise is at most"
            f" {ratio:.3g} times what the weights imply, whereas the ratio is {other.ratio:.3g} judging by"
            f" {other.origin}"
        )
    return None
