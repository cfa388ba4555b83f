"""Primary beams by name, for the commands that take one."""
# ruff: noqa: PLC0415  (help must not wait for imports)

from enum import StrEnum
from typing import TYPE_CHECKING, Annotated

import typer

from uvshear.errors import InputError

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from pathlib import Path

    from uvshear.interferometer.primary_beam import PrimaryBeam
    from uvshear.io.observations import Reading
    from uvshear.typing import Array, Float


class BeamName(StrEnum):
    """A primary beam."""

    NONE = "none"
    AIRY = "airy"
    COSINE_CUBED = "cosine-cubed"
    MEERKAT = "meerkat"


PrimaryBeamOption = Annotated[
    BeamName,
    typer.Option(
        "--primary-beam",
        help="Of the dishes, by their diameters: uniformly lit, or cos^3 of its width; or MeerKAT's.",
    ),
]


def pointed_beam(
    name: BeamName, paths: "Sequence[Path]", reading: "Reading"
) -> "PrimaryBeam | None":
    """Return the beam of the dishes of Measurement Sets, where these pointed."""
    from dataclasses import replace

    from uvshear.io.observations import dish_diameters, pointing_of

    beam = beam_of(name, lambda: dish_diameters(paths), str(paths[0]))
    return None if beam is None else replace(beam, pointing=pointing_of(paths, reading))


def beam_of(
    name: BeamName, diameters: "Callable[[], Float[Array, ' antenna']]", source: str
) -> "PrimaryBeam | None":
    """Return the beam of dishes of these diameters [m], which ``source`` gives where they are needed."""
    import numpy as np

    from uvshear.interferometer.primary_beam import AiryBeam, CosineCubedBeam, CosineTaperBeam

    if name is BeamName.NONE:
        return None
    if name is BeamName.MEERKAT:
        return CosineTaperBeam.of_meerkat()
    known = diameters()
    if not np.all(known > 0):
        raise InputError(
            f"--primary-beam {name.value}: {source} gives no diameter of a dish;"
            " --primary-beam meerkat or none needs none"
        )
    airy = AiryBeam.of_diameters(known)
    return airy if name is BeamName.AIRY else CosineCubedBeam(airy.width)
