"""A panel with the slopes of both components of the ellipticity, measured in several ways."""

from collections.abc import Mapping, Sequence

from uvshear.diagnostics.slope import Slope
from uvshear.plot.curves import Curve, CurvePanel


def slope_panel(slopes: Mapping[str, Sequence[Slope]]) -> CurvePanel:
    """Return the panel; ``slopes`` has the slopes of e1 and e2 by the name of each way."""
    curves = tuple(
        Curve(
            words,
            [0.0, 1.0],
            [slope.value for slope in both],
            [slope.error for slope in both],
            is_line=False,
        )
        for words, both in slopes.items()
    )
    return CurvePanel(
        "component of the ellipticity",
        "slope",
        curves,
        levels=(1.0,),
        names=("$e_1$", "$e_2$"),
    )
