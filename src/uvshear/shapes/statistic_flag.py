"""Why a source has no statistic of an estimator."""

from enum import Enum


class StatisticFlag(Enum):
    """Outcome of a statistic; the value is a sentence, and the lower-case name appears in tables."""

    OK = "the statistic was computed"
    NOT_MEASURED = "the source was not measured; the column flag of the shapes states why"
    NO_DATA = "no visibility on the baselines that the statistic uses carries weight"
    TOO_LARGE = "the source is too large for the statistic: not enough of the sky around it could be taken into account"
    NOT_FITTED = (
        "no galaxy could be fitted to the data, or to one of the sheared copies of the data"
    )

    @property
    def word(self) -> str:
        """The flag as it appears in tables."""
        return self.name.lower()


def flag_column(estimator: str) -> str:
    """Return the name of the column with the flags of an estimator."""
    return f"flag_{estimator}"
