"""What every picture must have, and shapes to draw."""

from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from uvshear.plot.figure import save


def check_picture(figure: Figure, directory: Path) -> None:
    """Raise unless every axis has a label, the figure has a title, and it can be written."""
    panels = [ax for ax in figure.axes if ax.get_label() != "<colorbar>"]
    assert panels
    for ax in panels:
        assert ax.get_xlabel()
        assert ax.get_ylabel()
    assert figure.get_suptitle() or all(ax.get_title() for ax in panels)
    path = directory / "picture.png"
    save(figure, path)
    assert path.read_bytes().startswith(b"\x89PNG")
    assert [p.name for p in directory.iterdir()] == ["picture.png"]


def check_east_is_left(figure: Figure) -> None:
    """Raise unless the horizontal axis of the first panel runs to the left."""
    left, right = figure.axes[0].get_xlim()
    assert left > right


def shapes() -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """True and measured ellipticities, errors and fluxes of 50 galaxies, one of them flagged."""
    rng = np.random.default_rng(2)
    true = rng.normal(0, 0.2, 50) + 1j * rng.normal(0, 0.2, 50)
    error = rng.uniform(0.02, 0.1, (50, 2))
    measured = true + rng.normal(0, 1, 50) * error[:, 0] + 1j * rng.normal(0, 1, 50) * error[:, 1]
    measured[3] = np.nan
    return true, measured, error, rng.uniform(1e-5, 1e-4, 50)
