"""The table of ``uvshear psf``: shapes of point spread functions, and the loss of information by a weighting."""
# ruff: noqa: PLC0415  (help must not wait for imports)

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, ParamSpec, TypeVar

from uvshear.cli.terminal import warn
from uvshear.errors import InputError

if TYPE_CHECKING:
    from uvshear.diagnostics.weighting_loss import WeightingLoss
    from uvshear.interferometer.psf_shape import MainLobe, PsfShape
    from uvshear.typing import Array, Float

P = ParamSpec("P")
T = TypeVar("T")


@dataclass(frozen=True)
class PsfFigures:
    """Shapes of one PSF with each Gaussian weight, and of its main lobe; None where a shape cannot be measured."""

    moments: "tuple[PsfShape | None, ...]"
    lobe: "MainLobe | None"

    @property
    def ellipticity(self) -> complex | None:
        """Ellipticity with the last of the Gaussian weights."""
        last = self.moments[-1]
        return last.ellipticity if last else None


def measure_figures(
    name: str, image: "Float[Array, 'l m']", pixel: float, sigmas: Sequence[float]
) -> PsfFigures:
    """Measure an image on pixels of ``pixel`` [rad] with Gaussian weights of these widths [arcsec]."""
    from uvshear.constants import ARCSEC
    from uvshear.interferometer.psf_shape import fit_main_lobe, measure_psf

    moments = [told(name, measure_psf, image, pixel, sigma * ARCSEC) for sigma in sigmas]
    return PsfFigures(tuple(moments), told(name, fit_main_lobe, image, pixel))


def told(name: str, measure: Callable[P, T], *arguments: P.args, **options: P.kwargs) -> T | None:
    """Return the result of a measurement; if it fails, show the reason under a name and return None."""
    try:
        return measure(*arguments, **options)
    except InputError as error:
        warn(f"{name}: {error}")
        return None


def shape_rows(figures: Sequence[PsfFigures], sigmas: Sequence[float]) -> list[tuple[str, ...]]:
    """Return the rows of the table with the shapes of PSFs, which are its columns."""
    from uvshear.constants import ARCSEC

    rows: list[tuple[str, ...]] = []
    for index, sigma in enumerate(sigmas):
        moments = [figure.moments[index] for figure in figures]
        weight = f"Gaussian weight of sigma {sigma:g} arcsec"
        rows += [
            _row(f"e1, {weight}", moments, lambda shape: f"{shape.ellipticity.real:+.4f}"),
            _row(f"e2, {weight}", moments, lambda shape: f"{shape.ellipticity.imag:+.4f}"),
            _row(
                f"size Q_ll + Q_mm, {weight}",
                moments,
                lambda shape: f"{shape.size / ARCSEC**2:.3f} arcsec2",
            ),
        ]
    lobes = [figure.lobe for figure in figures]
    return [
        *rows,
        _row("e1 of the main lobe", lobes, lambda lobe: f"{lobe.ellipticity.real:+.4f}"),
        _row("e2 of the main lobe", lobes, lambda lobe: f"{lobe.ellipticity.imag:+.4f}"),
        _row("FWHM of the main lobe", lobes, lambda lobe: f"{lobe.fwhm / ARCSEC:.3f} arcsec"),
    ]


def _row(name: str, values: Sequence[T | None], shown: Callable[[T], str]) -> tuple[str, ...]:
    return (name, *("-" if value is None else shown(value) for value in values))


def loss_rows(loss: "WeightingLoss", scale_length_arcsec: float) -> list[tuple[str, ...]]:
    """Return the rows of signal-to-noise ratios and information of weighted data, relative to natural weights."""
    disc = f"a disc of scale length {scale_length_arcsec:g} arcsec"
    return [
        ("relative SNR of a point source", "1", f"{loss.snr_point:.4f}"),
        (f"relative SNR of {disc}", "1", f"{loss.snr_galaxy:.4f}"),
        (f"relative information (1/variance) on e1 of {disc}", "1", f"{loss.information[0]:.4f}"),
        (f"relative information (1/variance) on e2 of {disc}", "1", f"{loss.information[1]:.4f}"),
    ]
