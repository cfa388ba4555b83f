from uvshear.reproduce.density_curves import curves_of_density
from uvshear.reproduce.finding import Estimate


def test_each_extraction_has_a_curve_of_one_component():
    series = {
        "paper": [(Estimate(0.9, 0.1), Estimate(0.8, 0.2)), (Estimate(0.7), Estimate(0.6))],
        "converged": [(Estimate(1.0, 0.1), Estimate(1.1, 0.3)), (Estimate(1.2), Estimate(1.3))],
    }
    paper, converged = curves_of_density((1.0, 2.8), series, 1)
    assert (paper.label, converged.label) == ("the paper's way", "converged extraction")
    assert paper.x == [1.0, 2.8]
    assert paper.y == [0.8, 0.6]
    assert converged.y == [1.1, 1.3]
    assert paper.error == [0.2, 0.0]
