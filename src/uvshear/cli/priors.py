"""Populations by name."""

from enum import StrEnum


class PriorName(StrEnum):
    """Where the population of a Bayesian shear comes from."""

    PAPER = "paper"
    FITTED = "fitted"
