"""Skies with known answers: galaxies drawn from a population, sheared, and observed."""
