"""The residual image of ``uvshear measure``: its file, and the picture beside it."""
# ruff: noqa: PLC0415  (help must not wait for imports)

from pathlib import Path
from typing import TYPE_CHECKING

from uvshear.cli.progress_report import progress_report
from uvshear.cli.terminal import say, shorten
from uvshear.constants import MICROJANSKY

if TYPE_CHECKING:
    from uvshear.io.provenance import Provenance
    from uvshear.pipeline.measurement import Measurement
    from uvshear.progress import Observer


def write_residual(
    measurement: "Measurement",
    made: "Provenance",
    path: Path,
    logged: "Observer | None",
    *,
    overwrite: bool,
) -> None:
    """Image what a measurement has left, write and draw the images, and print the rms of the residual."""
    from uvshear.io.images import write_residual_image
    from uvshear.plot import draw_residual_image, save

    assert measurement.field is not None
    with progress_report("imaging", logged) as progress:
        images = measurement.residual_image(progress=progress)
    centre = measurement.field.observation.phase_centre
    write_residual_image(path, images, centre, made.metadata(), overwrite=overwrite)
    picture = picture_of(path)
    title = shorten(Path(made.inputs[0]).name)
    save(draw_residual_image(images, title), picture, overwrite=overwrite)
    rms, noise = images.rms / MICROJANSKY, images.noise / MICROJANSKY
    say(
        f"{path}, {picture}: the rms of the residual is {rms:.4g} uJy/beam, and the thermal noise is"
        f" {noise:.4g} uJy/beam"
    )


def picture_of(image: Path) -> Path:
    """Return the name of the picture that goes with an image."""
    return image.with_suffix(".png")


def checked_residual_image(image: Path, *, overwrite: bool) -> tuple[Path, Path]:
    """Return the residual image and its picture, after the check that both can be written."""
    from uvshear.io.images import check_image_name
    from uvshear.io.outputs import check_file

    check_image_name(image)
    files = image, picture_of(image)
    for path in files:
        check_file(path, overwrite=overwrite)
    return files
