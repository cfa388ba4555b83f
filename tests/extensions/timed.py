"""An extraction of one's own: the package's, with its time."""

import time
from dataclasses import replace

from uvshear import ConvergedExtraction


class Timed(ConvergedExtraction):
    """The converged extraction, with its time in the record."""

    def extract(self, observation, field, setting, progress=None):
        """Measure all sources."""
        start = time.perf_counter()
        extracted = super().extract(observation, field, setting, progress)
        seconds = time.perf_counter() - start
        return replace(extracted, record={**extracted.record, "seconds": seconds})
