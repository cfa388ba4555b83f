"""The option of a primary beam, for the commands that take one."""
# ruff: noqa: PLC0415  (help must not wait for imports)

from typing import TYPE_CHECKING, Annotated, Final

import typer

from uvshear.cli.panels import MODEL
from uvshear.cli.registered import named_by

if TYPE_CHECKING:
    from collections.abc import Callable

    from uvshear.interferometer.attenuation import Attenuation
    from uvshear.interferometer.visibilities import Observation
    from uvshear.typing import Array, Float

NONE: Final = "none"

PrimaryBeamOption = Annotated[
    str,
    typer.Option(
        "--primary-beam",
        metavar="NAME",
        rich_help_panel=MODEL,
        help="Primary beam of the dishes: none, airy (uniformly illuminated dishes with the diameters of the"
        " ANTENNA table or the layout), cosine-cubed (a cos^3 power beam with the same FWHM), meerkat, or"
        " MODULE:NAME of your own.",
    ),
]


def beam_of_observation(name: str, observation: "Observation") -> "Attenuation | None":
    """Return the beam of the dishes of an observation, about their pointing; None for the name ``none``."""
    from uvshear.interferometer.dishes import dish_diameters, pointing_of

    if name == NONE:
        return None
    return beam_of_dishes(name, lambda: dish_diameters(observation), pointing_of(observation))


def beam_of_dishes(
    name: str,
    diameters: "Callable[[], Float[Array, ' antenna']]",
    pointing: tuple[float, float] = (0.0, 0.0),
) -> "Attenuation | None":
    """Return the beam of dishes of these diameters [m]; None for the name ``none``."""
    from uvshear.interferometer.beam_registry import primary_beam_named

    if name == NONE:
        return None
    with named_by("--primary-beam", name):
        return primary_beam_named(name, diameters, pointing)
