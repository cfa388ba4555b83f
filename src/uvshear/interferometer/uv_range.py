"""Range of the baselines that are used."""

from dataclasses import dataclass


@dataclass(frozen=True)
class UvRange:
    """Lengths of the baselines on which shapes are measured [wavelengths]."""

    minimum: float = 0.0
    maximum: float = float("inf")

    @property
    def is_everything(self) -> bool:
        """Whether all baselines are used."""
        return self.minimum <= 0 and self.maximum == float("inf")
