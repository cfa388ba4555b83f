"""Every command that writes, on small inputs."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

OBSERVATION = "--declination-deg -30 --hours 4 --integration-s 1200 --band-mhz 950 1190"

INPUTS = (
    "catalogue --field-arcmin 2 --count 3 --flux-ujy 100 200 --declination-deg -30 --seed 2 -o cat.fits",
    f"simulate --layout array.txt --catalogue cat.fits {OBSERVATION} --snr-at 10 10 --seed 1 --threads 1 -o in.ms",
    "measure in.ms --catalogue cat.fits --keep moments --threads 1 -o in.fits",
)
"""Commands that make the inputs, which are not killed."""


@dataclass(frozen=True)
class Command:
    """A command line and its outputs, the one that appears last at the end.

    Parameters
    ----------
    words
        Command line, whose paths are in the working directory.
    outputs
        Files and directories that it writes.
    is_one_set
        Whether the outputs belong together.
    """

    words: str
    outputs: tuple[str, ...]
    is_one_set: bool = False

    def in_directory(self, directory: Path) -> list[Path]:
        """Return the paths of the outputs."""
        return [directory / name for name in self.outputs]


COMMANDS: Mapping[str, Command] = {
    "layouts": Command("layouts vla-b -o map.png", ("map.png",)),
    "catalogue": Command(
        "catalogue --field-arcmin 2 --density 2.8 --seed 1 -o out.ecsv", ("out.ecsv",)
    ),
    "simulate": Command(
        f"simulate --layout array.txt --catalogue cat.fits {OBSERVATION} --snr-at 10 10 --seed 1 --threads 1"
        " -o out.ms",
        ("out.ms",),
    ),
    "psf": Command(
        "psf in.ms --pixel-arcsec 0.5 --threads 1 -o psf.png --uv-output uv.png",
        ("psf.png", "uv.png"),
    ),
    "average": Command(
        "average in.ms --field-arcmin 4 --threads 1 -o compact.ms",
        ("compact.ms",),
    ),
    "measure": Command(
        "measure in.ms --catalogue cat.fits --keep moments --threads 1 -o out.fits",
        ("out.stats.fits", "out.sky.fits", "out.fits"),
        is_one_set=True,
    ),
    "reproduce": Command(
        "reproduce psf-images --threads 1 -o reproduced",
        (
            "reproduced/psf-images.png",
            "reproduced/psf-images.json",
            "reproduced/index.md",
        ),
    ),
    "shear": Command("shear in.fits --estimator moments -o shear.json", ("shear.json",)),
    "bias": Command(
        "bias --estimator mean --galaxies 100 --layout array.txt --hours 1 --integration-s 600 --threads 1"
        " -o bias.json",
        ("bias.json",),
    ),
}
