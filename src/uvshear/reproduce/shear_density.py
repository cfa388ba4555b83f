"""Target ``shear-density``: shear of a population without an input shear, against its density (section 5)."""

from collections.abc import Mapping
from dataclasses import dataclass

from uvshear.plot.curves import CurvePanel, draw_curves
from uvshear.reproduce.crowded_field import EXTRACTIONS, CrowdedField
from uvshear.reproduce.density_curves import Series, curves_of_density
from uvshear.reproduce.finding import Finding, Quantity
from uvshear.reproduce.paper_pointing import PaperPointing
from uvshear.reproduce.paper_target import PaperTarget
from uvshear.reproduce.shape_sample import sample_named
from uvshear.reproduce.shear_statistics import mean_bias
from uvshear.typing import Array

RING = 10
"""Number of galaxies whose ellipticities are equally spaced on a circle (section 5)."""


@dataclass(frozen=True)
class ShearDensity(PaperTarget):
    """Mean ellipticity of galaxies that are measured together in one field, in rings of ten.

    Parameters
    ----------
    densities
        Numbers of galaxies per square arcminute.
    galaxies
        Number of galaxies in a field at a density of 1, to which the numbers at other densities are proportional.
    fields
        Number of fields at each density.
    integration
        Length of a sample [s].
    """

    name = "shear-density"
    title = "Shear without an input shear, against density"

    densities: tuple[float, ...] = (1.0, 2.8, 5.0, 8.0)
    galaxies: int = 400
    fields: int = 9
    integration: float = 900.0

    def tasks(self) -> Mapping[str, CrowdedField]:
        """Return the fields, each measured in two ways."""
        pointing = PaperPointing(integration=self.integration)
        return {
            f"{way}-{density:g}-{field}": CrowdedField(
                way,
                pointing,
                RING * round(self.galaxies * density / RING),
                density,
                RING,
                1000 * self.seed + 500 + field,
            )
            for density in self.densities
            for way in EXTRACTIONS
            for field in range(self.fields)
        }

    def measure(self, task: CrowdedField) -> Mapping[str, Array]:
        """Simulate and measure a field."""
        return task.measured()

    def finding(self, found: Mapping[str, Mapping[str, Array]]) -> Finding:
        """Compare the shears at each density."""
        quantities: list[Quantity] = []
        series: Series = {way: [] for way in EXTRACTIONS}
        for density in self.densities:
            for way in EXTRACTIONS:
                series[way].append(mean_bias(sample_named(found, f"{way}-{density:g}"), (0j,)).c)
            for part in (0, 1):
                quantities.append(
                    Quantity(
                        f"g{part + 1} at {density:g} per arcmin², no input shear",
                        None,
                        series["paper"][-1][part],
                        series["converged"][-1][part],
                    )
                )
        panels = [
            CurvePanel(
                "galaxies per square arcminute",
                f"$g_{part + 1}$",
                tuple(curves_of_density(self.densities, series, part)),
                levels=(0.0,),
            )
            for part in (0, 1)
        ]
        caption = (
            "Mean ellipticity of galaxies that are measured together in one field, without an input shear, against"
            " their number density. Errors are from the scatter among rings of ten galaxies."
        )
        remarks = (
            f"Each density has {self.fields} fields of the same width; a field has {self.galaxies} galaxies at a"
            " density of 1 per square arcminute. Ten galaxies each, called a ring, have ellipticities of the same"
            " modulus that are equally spaced in direction. In the paper the errors are from 1000 bootstrap resamples.",
        )
        return Finding(tuple(quantities), draw_curves(panels), caption, remarks)
