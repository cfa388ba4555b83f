"""Target ``shear-bias-crowded``: multiplicative and additive bias of galaxies measured together (Table 2)."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

from uvshear.plot.curves import draw_curves
from uvshear.reproduce.causes_of_c import TRACK_WORDS
from uvshear.reproduce.crowded_field import EXTRACTIONS, WORDS, CrowdedField
from uvshear.reproduce.finding import Finding, Quantity
from uvshear.reproduce.paper_pointing import UNTIL_TRANSIT, PaperPointing
from uvshear.reproduce.paper_target import PaperTarget
from uvshear.reproduce.published_figures import PublishedFigures
from uvshear.reproduce.shape_sample import ShapeSample, sample_named
from uvshear.reproduce.shear_bias import CUTS, SHEARS, above, rows_of_c, shear_panel
from uvshear.reproduce.shear_density import RING
from uvshear.reproduce.shear_statistics import MeanBias, mean_bias
from uvshear.typing import Array

EARLIER = "earlier"
"""Beginning of the names of parts with a track that ends at transit."""


@dataclass(frozen=True)
class CrowdedShearBias(PaperTarget):
    """Bias of the mean ellipticity of galaxies that are measured together in one field, with eight shears.

    Parameters
    ----------
    galaxies
        Number of galaxies in a field, in rings of ten.
    fields
        Number of fields.
    density
        Number of galaxies per square arcminute.
    integration
        Length of a sample [s].
    """

    name = "shear-bias-crowded"
    title = "Shear bias of galaxies measured together"

    galaxies: int = 1120
    fields: int = 9
    density: float = 2.8
    integration: float = 900.0

    def tasks(self) -> Mapping[str, CrowdedField]:
        """Return every field with every shear, and without one with another track, measured in two ways."""
        pointing = PaperPointing(integration=self.integration)
        other = replace(pointing, times=UNTIL_TRANSIT)
        sheared = {
            f"{way}-{field}-{shear}": CrowdedField(
                way,
                pointing,
                self.galaxies,
                self.density,
                RING,
                1000 * self.seed + 800 + field,
                SHEARS,
                shear,
            )
            for field in range(self.fields)
            for shear in range(len(SHEARS))
            for way in EXTRACTIONS
        }
        unsheared = {
            f"{EARLIER}-{way}-{field}": CrowdedField(
                way,
                other,
                self.galaxies,
                self.density,
                RING,
                1000 * self.seed + 800 + field,
            )
            for field in range(self.fields)
            for way in EXTRACTIONS
        }
        return sheared | unsheared

    def measure(self, task: CrowdedField) -> Mapping[str, Array]:
        """Simulate and measure a field."""
        return task.measured()

    def finding(self, found: Mapping[str, Mapping[str, Array]]) -> Finding:
        """Compare m and c with those of Table 2."""
        printed = PublishedFigures.read(self.name)
        samples = {
            way: ShapeSample.join(part for key, part in found.items() if key.startswith(way))
            for way in EXTRACTIONS
        }
        quantities: list[Quantity] = []
        biases: dict[str, dict[str, MeanBias]] = {}
        for cut, flux in CUTS.items():
            biases[cut] = {
                way: mean_bias(above(sample, flux), SHEARS) for way, sample in samples.items()
            }
            for part in (0, 1):
                for what in ("m", "c"):
                    as_paper, own = (getattr(biases[cut][way], what)[part] for way in EXTRACTIONS)
                    quantities.append(
                        Quantity(
                            f"{what}{part + 1}, SNR ≥ {cut}, multiple sources",
                            printed.estimate(f"{what}{part + 1}_snr{cut}"),
                            as_paper,
                            own,
                        )
                    )
        quantities += _rows_of_the_other_track(found, printed)
        panels = [
            shear_panel(cut, {WORDS[way]: bias for way, bias in found_at.items()})
            for cut, found_at in biases.items()
        ]
        caption = (
            "Mean ellipticities of galaxies that are measured together in one field, with eight input shears of modulus"
            " 0.04 (crosses): the extraction of the paper and the converged extraction, for galaxies above a"
            " signal-to-noise ratio of 10 (left) and 25 (right)."
        )
        remarks = (
            f"There are {self.fields} fields of {self.galaxies} galaxies in rings of ten, at {self.density:g} per"
            " square arcminute. A field has the same noise with all shears. Shears change ellipticities and leave"
            " scale lengths alone, as in the paper. The track is about transit. The last rows are an experiment with a"
            " track that ends at transit, without a shear; see `shear-bias` for the reasons. The"
            " direction of c is that of the PSF, and depends on the layout of the array.",
        )
        return Finding(tuple(quantities), draw_curves(panels), caption, remarks)


def _rows_of_the_other_track(
    found: Mapping[str, Mapping[str, Array]], printed: PublishedFigures
) -> list[Quantity]:
    """Compare c without a shear, with a track that ends at transit."""
    samples = [sample_named(found, f"{EARLIER}-{way}") for way in EXTRACTIONS]
    rows: list[Quantity] = []
    for cut, flux in CUTS.items():
        in_print = (printed.estimate(f"c1_snr{cut}"), printed.estimate(f"c2_snr{cut}"))
        columns = (in_print, *(mean_bias(above(sample, flux), (0j,)).c for sample in samples))
        words = f"SNR ≥ {cut}, multiple sources, {TRACK_WORDS[EARLIER]}"
        rows += rows_of_c(words, *columns)
    return rows
