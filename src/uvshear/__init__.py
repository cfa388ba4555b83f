"""Weak-lensing galaxy shapes and shear, measured directly from interferometric visibilities.

``simulate`` lets an array observe galaxies, ``measure`` turns visibilities and a catalogue into shapes,
``estimate_shear`` shapes into shear. The objects that describe them - facets, profiles, priors, layouts - live in
the subpackages that bear their names.
"""

from typing import TYPE_CHECKING, Any

__version__ = "0.1.0"

if TYPE_CHECKING:
    from uvshear.extraction import MeasurementOptions
    from uvshear.pipeline import estimate_shear, measure, simulate

__all__ = ["MeasurementOptions", "__version__", "estimate_shear", "measure", "simulate"]


def __getattr__(name: str) -> Any:
    """Import the pipeline when it is first asked for: ``uvshear --help`` shall not wait for it."""
    if name in __all__:
        from uvshear import pipeline  # noqa: PLC0415

        return getattr(pipeline, name)
    raise AttributeError(f"module 'uvshear' has no attribute '{name}'")
