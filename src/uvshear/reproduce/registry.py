"""The targets at each scale."""

from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Final

from uvshear.errors import InputError
from uvshear.reproduce.averaging_test import AveragingTest
from uvshear.reproduce.c_facets import FacetBias
from uvshear.reproduce.c_round import RoundBias
from uvshear.reproduce.c_size import SizeBias
from uvshear.reproduce.c_snapshots import SnapshotBias
from uvshear.reproduce.c_zenith import ZenithBias
from uvshear.reproduce.density import DensityTarget
from uvshear.reproduce.facet_residuals import FacetResiduals
from uvshear.reproduce.facet_size import FacetSize
from uvshear.reproduce.fit_timing import FitTiming
from uvshear.reproduce.gridded_model import GriddedModel
from uvshear.reproduce.metacal_round import MetacalRound
from uvshear.reproduce.names import PAPER, QUICK, SCALES, TARGETS
from uvshear.reproduce.paper_pointing import BASELINE, PaperPointing
from uvshear.reproduce.paper_target import PaperTarget
from uvshear.reproduce.psf_images import PsfImages
from uvshear.reproduce.psf_zenith import PsfZenith
from uvshear.reproduce.shear_bias import ShearBias
from uvshear.reproduce.shear_bias_crowded import CrowdedShearBias
from uvshear.reproduce.shear_density import ShearDensity
from uvshear.reproduce.weighting_test import WeightingTest

Maker = Callable[[int], PaperTarget]
"""Function from a seed to a target."""

COARSE: Final = 900.0
"""Integration with which the track is sampled for speed [s]: 0.62 million rows instead of 9.27 million. The noise is
scaled such that signal-to-noise ratios are the same."""

_BY_SCALE: Final[Mapping[str, Mapping[str, Maker]]] = MappingProxyType(
    {
        QUICK: {
            "psf-images": lambda seed: PsfImages(seed, PaperPointing(integration=COARSE)),
            "psf-zenith": lambda seed: PsfZenith(seed, integration=COARSE),
            "facet-size": lambda seed: FacetSize(
                seed,
                PaperPointing(integration=COARSE),
                40,
                searched=6,
                fractions=(0.2, 0.5, 1.0, 1.5),
            ),
            "facet-residuals": lambda seed: FacetResiduals(
                seed, PaperPointing(integration=COARSE), 150
            ),
            "weighting": lambda seed: WeightingTest(
                seed, PaperPointing(integration=COARSE), 60, 20
            ),
            "gridded-model": lambda seed: GriddedModel(
                seed, PaperPointing(integration=COARSE), 20, 10
            ),
            "averaging": lambda seed: AveragingTest(seed, BASELINE, 40, 20),
            "shear-bias": lambda seed: ShearBias(
                seed, PaperPointing(integration=COARSE), 8, 6, block=2, tracked=8
            ),
            "shear-bias-crowded": lambda seed: CrowdedShearBias(seed, 20, 1, integration=1800.0),
            "c-round": lambda seed: RoundBias(seed, COARSE, 24, 8, fewer=8),
            "c-zenith": lambda seed: ZenithBias(seed, COARSE, 24, 8, with_cells=8),
            "c-size": lambda seed: SizeBias(seed, COARSE, 24, 8),
            "c-snapshots": lambda seed: SnapshotBias(seed, COARSE, 24, 8),
            "c-facets": lambda seed: FacetBias(seed, COARSE, 8, 8),
            "density": lambda seed: DensityTarget(seed, (1.0, 2.8), 60, 1, 1800.0, 120, COARSE),
            "shear-density": lambda seed: ShearDensity(seed, (1.0, 2.8), 20, 2, 1800.0),
            "metacal-round": lambda seed: MetacalRound(
                seed, PaperPointing(integration=COARSE), 40, 10
            ),
            "timing": lambda seed: FitTiming(seed, PaperPointing(integration=COARSE), 100),
        },
        PAPER: {
            "psf-images": PsfImages,
            "psf-zenith": PsfZenith,
            "facet-size": lambda seed: FacetSize(seed, PaperPointing(integration=COARSE)),
            "facet-residuals": lambda seed: FacetResiduals(seed, PaperPointing(integration=COARSE)),
            "weighting": lambda seed: WeightingTest(seed, PaperPointing(integration=COARSE)),
            "gridded-model": lambda seed: GriddedModel(seed, PaperPointing(integration=COARSE)),
            "averaging": AveragingTest,
            "shear-bias": lambda seed: ShearBias(seed, PaperPointing(integration=COARSE), 300, 50),
            "shear-bias-crowded": CrowdedShearBias,
            "c-round": lambda seed: RoundBias(seed, galaxies=2000),
            "c-zenith": ZenithBias,
            "c-size": SizeBias,
            "c-snapshots": SnapshotBias,
            "c-facets": FacetBias,
            "density": DensityTarget,
            "shear-density": ShearDensity,
            "metacal-round": lambda seed: MetacalRound(seed, PaperPointing(integration=COARSE)),
            "timing": lambda seed: FitTiming(seed, PaperPointing(integration=COARSE)),
        },
    }
)


def targets_at(scale: str, names: tuple[str, ...] = (), seed: int = 1) -> tuple[PaperTarget, ...]:
    """Return targets at a scale, all of them unless names are given, in the order of the page.

    Raises
    ------
    InputError
        A name or the scale is not known.
    """
    if scale not in SCALES:
        raise InputError(f"scale '{scale}' is not known; the known scales are {', '.join(SCALES)}")
    for name in names:
        if name not in TARGETS:
            raise InputError(
                f"target '{name}' is not known; the known targets are {', '.join(TARGETS)}"
            )
    return tuple(
        make(seed) for name, make in _BY_SCALE[scale].items() if not names or name in names
    )
