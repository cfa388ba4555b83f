"""The residual image of ``uvshear measure``: its file, and the picture beside it."""
# ruff: noqa: PLC0415  (help must not wait for imports)

from pathlib import Path
from typing import TYPE_CHECKING

from uvshear.cli.terminal import say
from uvshear.constants import MICROJANSKY
from uvshear.errors import InputError

if TYPE_CHECKING:
    from uvshear.diagnostics.residual_image import DirtyAndResidual


def draw_residual(images: "DirtyAndResidual", title: str, path: Path, *, overwrite: bool) -> None:
    """Draw the images, and print the rms of the residual."""
    from uvshear.plot import draw_residual_image, save

    picture = picture_of(path)
    save(draw_residual_image(images, title), picture, overwrite=overwrite)
    rms, noise = images.rms / MICROJANSKY, images.noise / MICROJANSKY
    say(
        f"{path}, {picture}: the rms of the residual is {rms:.4g} uJy/beam, and the thermal noise is"
        f" {noise:.4g} uJy/beam"
    )


def picture_of(image: Path) -> Path:
    """Return the name of the picture that goes with an image."""
    return image.with_suffix(".png")


def check_residual_image(image: Path, output: Path, catalogue: Path, *, overwrite: bool) -> None:
    """Refuse a residual image that cannot be written, or whose picture cannot, before anything is computed."""
    from uvshear.io.images import check_image_name
    from uvshear.io.outputs import check_file
    from uvshear.pipeline.measurement import companions

    check_image_name(image)
    for path in (image, picture_of(image)):
        if path.absolute() in {other.absolute() for other in (output, *companions(output))}:
            raise InputError(
                f"--residual-image {image}: {path} is also an output of -o {output}; give two names"
            )
        check_file(path, overwrite=overwrite, inputs=(catalogue,))
