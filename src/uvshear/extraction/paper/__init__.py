"""The source extraction of Rivi & Miller 2018, section 2.2: one source after the other, in decreasing flux."""

from uvshear.extraction.paper.extraction import PaperExtraction

__all__ = ["PaperExtraction"]
