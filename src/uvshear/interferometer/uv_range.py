"""Lengths of baselines that take part."""

from dataclasses import dataclass


@dataclass(frozen=True)
class UvRange:
    """Baseline lengths that take part in the shape [wavelengths]."""

    minimum: float = 0.0
    maximum: float = float("inf")

    @property
    def is_everything(self) -> bool:
        """Whether nothing is cut."""
        return self.minimum <= 0 and self.maximum == float("inf")
