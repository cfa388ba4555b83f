"""Primary beams by name: those of the package, those of installed packages, and those of a user's own file."""

from collections.abc import Callable
from typing import Protocol

import numpy as np

from uvshear.errors import InputError
from uvshear.interferometer.attenuation import Attenuation
from uvshear.interferometer.primary_beam import AiryBeam, CosineCubedBeam, CosineTaperBeam
from uvshear.plugins import Registry
from uvshear.typing import Array, Float

_HERE = "uvshear.interferometer.beam_registry"

PRIMARY_BEAMS = Registry(
    "primary beam",
    "uvshear.primary_beams",
    {
        "airy": f"{_HERE}:airy",
        "cosine-cubed": f"{_HERE}:cosine_cubed",
        "meerkat": f"{_HERE}:meerkat",
    },
    {},
)
"""Every registered object is a :class:`BeamFactory`."""


class BeamFactory(Protocol):
    """Function, or class, that makes the primary beam of an array.

    It is called with two arguments: ``diameters``, the diameter of each antenna's dish [m], 0 where it is not known;
    and ``pointing``, the direction cosines (l, m) of the pointing direction about the phase centre. It returns an
    :class:`~uvshear.interferometer.attenuation.Attenuation`, whose ``factor`` is the product of the voltage beams of
    the two antennas of each sample. It raises an ``InputError`` if it needs the diameter of a dish that is not known.
    """

    def __call__(
        self, diameters: Float[Array, " antenna"], pointing: tuple[float, float], /
    ) -> Attenuation:
        """Return the beam."""
        ...


def primary_beam_named(
    name: str,
    diameters: Callable[[], Float[Array, " antenna"]] | Float[Array, " antenna"],
    pointing: tuple[float, float] = (0.0, 0.0),
) -> Attenuation:
    """Return the primary beam of a name for an array of dishes.

    Parameters
    ----------
    name
        A registered name, or ``MODULE:NAME``.
    diameters
        Diameter of each antenna's dish [m], or a function that returns it; 0 or NaN where it is not known.
    pointing
        Direction cosines (l, m) of the pointing direction.
    """
    make: BeamFactory = PRIMARY_BEAMS.find(name)
    if not callable(make):
        raise InputError(f"the primary beam '{name}' is not a function of diameters and pointing")
    known = np.nan_to_num(diameters() if callable(diameters) else diameters, nan=0.0)
    beam = make(known, pointing)
    if not isinstance(beam, Attenuation):
        raise InputError(
            f"the primary beam '{name}' is not an Attenuation but has the type {type(beam).__name__}"
        )
    return beam


def airy(diameters: Float[Array, " antenna"], pointing: tuple[float, float]) -> AiryBeam:
    """Return the beam of uniformly illuminated dishes."""
    return AiryBeam.from_diameters(diameters, pointing)


def cosine_cubed(
    diameters: Float[Array, " antenna"], pointing: tuple[float, float]
) -> CosineCubedBeam:
    """Return the power beam cos^3, as wide as that of uniformly illuminated dishes."""
    return CosineCubedBeam.from_diameters(diameters, pointing)


def meerkat(diameters: Float[Array, " antenna"], pointing: tuple[float, float]) -> CosineTaperBeam:
    """Return the beam of MeerKAT, whatever the diameters."""
    return CosineTaperBeam.meerkat(pointing)
