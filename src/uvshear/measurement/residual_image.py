"""The picture after a measurement: what is left of the field, with the sky that was found taken away."""

from uvshear.extraction.residual import Gridding, block_of
from uvshear.extraction.residual_image import DirtyAndResidual, residual_image
from uvshear.interferometer.visibilities import Observation
from uvshear.measurement.extraction import Extracted
from uvshear.measurement.field import Field
from uvshear.measurement.options import MeasurementOptions
from uvshear.progress import Progress


def image_residual(
    observation: Observation,
    field: Field,
    extracted: Extracted,
    options: MeasurementOptions,
    *,
    progress: Progress | None = None,
) -> DirtyAndResidual:
    """Visit the baselines that took part once more, for the dirty image and for what ``extracted.sky`` leaves."""
    done = 0.0

    def step(samples: float) -> None:
        nonlocal done
        done += samples / 3  # predicted, and imaged twice
        if progress is not None:
            progress(round(done), field.extent.samples)

    return residual_image(
        observation,
        extracted.sky.select(field.modelled),
        options.profile,
        extent=field.extent,
        uv_range=extracted.uv_range,
        gridding=Gridding(block=block_of(options.memory), threads=options.threads),
        attenuation=(
            options.attenuation(observation.phase_centre.dec)
            if options.extraction.models_losses
            else None
        ),
        step=step,
    )
