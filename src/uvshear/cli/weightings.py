"""Options of the weights of baselines, with the names that are usual in imagers."""
# ruff: noqa: PLC0415  (help must not wait for imports)

from dataclasses import dataclass
from enum import StrEnum
from typing import TYPE_CHECKING, Annotated

import typer

from uvshear.cli.options import finite, positive
from uvshear.cli.panels import METHOD
from uvshear.errors import InputError

if TYPE_CHECKING:
    from uvshear.interferometer.weighting import Weighting


class WeightName(StrEnum):
    """A weighting, from the best signal-to-noise ratio to the best resolution."""

    NATURAL = "natural"
    UNIFORM = "uniform"
    BRIGGS = "briggs"


WeightOption = Annotated[
    WeightName,
    typer.Option(
        "--weight",
        rich_help_panel=METHOD,
        help="Weighting of the visibilities; all but natural weights cost information.",
    ),
]
RobustOption = Annotated[
    float | None,
    typer.Option(
        "--robust",
        callback=finite,
        rich_help_panel=METHOD,
        help="Briggs robustness, from -2 (nearly uniform) to 2 (nearly natural); required with --weight briggs.",
    ),
]
USUAL_FIELD = 10.0
"""Default field of view, whose inverse is the width of the uv cells [arcmin]."""

WeightFieldOption = Annotated[
    float | None,
    typer.Option(
        "--weight-field-arcmin",
        callback=positive,
        rich_help_panel=METHOD,
        help="Field of view that sets the width of the uv cells (its inverse) for --weight uniform and briggs; 10 by"
        " default. Imagers usually take the width of the image here; wsclean takes 1.2 times that width.",
        show_default=False,
    ),
]
GaussianTaperOption = Annotated[
    float | None,
    typer.Option(
        "--taper-gaussian-arcsec",
        callback=positive,
        rich_help_panel=METHOD,
        help="Gaussian taper, given by the FWHM of its Fourier transform on the sky.",
    ),
]
TukeyTaperOption = Annotated[
    float | None,
    typer.Option(
        "--taper-tukey",
        callback=positive,
        rich_help_panel=METHOD,
        help="Length of the cosine taper that ends at --uv-max, which is then required [wavelengths].",
    ),
]
InnerTukeyTaperOption = Annotated[
    float | None,
    typer.Option(
        "--taper-inner-tukey",
        callback=positive,
        rich_help_panel=METHOD,
        help="Length of the cosine taper that begins at --uv-min, which is then required [wavelengths].",
    ),
]
RoundPsfOption = Annotated[
    bool,
    typer.Option(
        "--round-psf",
        rich_help_panel=METHOD,
        help="Reweight the visibilities by position angle within each annulus of the uv plane so that the PSF is"
        " round.",
    ),
]


@dataclass(frozen=True)
class WeightChoice:
    """The weighting that the options describe."""

    weight: WeightName
    robust: float | None
    field_arcmin: float | None
    taper_gaussian_arcsec: float | None
    taper_tukey: float | None
    taper_inner_tukey: float | None
    round_psf: bool

    def weightings(self, uv_min: float, uv_max: float | None) -> "tuple[Weighting, ...]":
        """Return the weightings in the order of application, without the uv range; natural weights have none."""
        import math

        from uvshear.constants import ARCSEC
        from uvshear.interferometer.weighting import (
            Briggs,
            GaussianTaper,
            RoundPsf,
            TukeyTaper,
            Uniform,
        )

        if (self.robust is not None) != (self.weight is WeightName.BRIGGS):
            raise InputError(
                "--weight briggs: --robust is required"
                if self.robust is None
                else f"--weight {self.weight.value} --robust {self.robust:g}: --robust applies only to --weight briggs"
            )
        if self.field_arcmin is not None and self.weight is WeightName.NATURAL:
            raise InputError(
                f"--weight-field-arcmin {self.field_arcmin:g}: natural weights have no cells;"
                " --weight uniform or briggs is needed"
            )
        if self.taper_tukey is not None and uv_max is None:
            raise InputError(
                f"--taper-tukey {self.taper_tukey:g}: the taper ends at --uv-max, which must be given"
            )
        if self.taper_inner_tukey is not None and not uv_min:
            raise InputError(
                f"--taper-inner-tukey {self.taper_inner_tukey:g}: the taper begins at --uv-min, which must be given"
            )
        longest = math.inf if uv_max is None else uv_max
        rise, fall = self.taper_inner_tukey or 0.0, self.taper_tukey or 0.0
        if rise + fall > longest - uv_min:
            raise InputError(
                f"--taper-inner-tukey {rise:g} --taper-tukey {fall:g}: the tapers are longer than the uv range"
            )
        chosen: list[Weighting] = []
        field = math.radians((self.field_arcmin or USUAL_FIELD) / 60)
        if self.weight is WeightName.UNIFORM:
            chosen.append(Uniform(field))
        if self.robust is not None:
            chosen.append(Briggs(self.robust, field))
        if self.taper_gaussian_arcsec is not None:
            chosen.append(GaussianTaper(self.taper_gaussian_arcsec * ARCSEC))
        if rise or fall:
            chosen.append(TukeyTaper(uv_min, longest, rise, fall))
        if self.round_psf:
            chosen.append(RoundPsf())
        return tuple(chosen)
