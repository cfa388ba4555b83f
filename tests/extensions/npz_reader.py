"""A reader of another format: arrays in one file of numpy."""

from dataclasses import dataclass, field

import numpy as np

from uvshear import PhaseCentre, Reader, Visibilities, VisibilitySet


@dataclass(frozen=True)
class NpzObservation(VisibilitySet):
    """Visibilities in memory, of dishes of known diameters [m] that pointed at the phase centre."""

    diameters: np.ndarray = field(kw_only=True)

    def dish_diameters(self):
        """Return the diameter of each antenna's dish [m]."""
        return self.diameters

    def pointing_direction(self):
        """Return the direction in which the dishes pointed."""
        return self.phase_centre


class NpzReader(Reader):
    """Arrays uvw [m], frequency [Hz], stokes_i [Jy], weights [Jy^-2], phase_centre [rad] and diameters [m]."""

    format = "npz (a file that ends in .npz)"

    def recognises(self, path):
        """Tell whether the name is that of such a file."""
        return path.suffix == ".npz"

    def open(self, path, reading):
        """Open a file."""
        with np.load(path) as file:
            block = Visibilities(file["uvw"], file["frequency"], file["stokes_i"], file["weights"])
            centre = PhaseCentre(*map(float, file["phase_centre"]))
            return NpzObservation(centre, (block,), diameters=file["diameters"])
