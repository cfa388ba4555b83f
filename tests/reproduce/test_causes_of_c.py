import math

from uvshear.reproduce.causes_of_c import (
    MEASURED_CUT,
    ONE_REALISATION,
    PAPER_RINGS,
    TRACK_WORDS,
    causes_of_c,
)
from uvshear.reproduce.finding import Estimate, Quantity

PAPER = (Estimate(0.006, 0.0003), Estimate(0.008, 0.0004))
C = {
    "about": (0.0, 0.0005),
    "later": (0.003, -0.004),
    "earlier": (0.003, 0.004),
}


def _rows():
    rows = []
    for track, words in TRACK_WORDS.items():
        for part in (0, 1):
            name = f"c{part + 1}, SNR ≥ 10, {words}"
            rows.append(Quantity(name, PAPER[part], Estimate(C[track][part], 0.001)))
        modulus = Estimate(math.hypot(*C[track]), 0.001)
        name = f"modulus of c, SNR ≥ 10, {words}"
        rows.append(Quantity(name, Estimate(0.01, 0.0005), modulus, modulus))
    for words, value in ((ONE_REALISATION, 0.002), (MEASURED_CUT, 0.0015)):
        rows += [
            Quantity(f"c{part}, SNR ≥ 10, {words}", PAPER[part - 1], Estimate(value, 0.006))
            for part in (1, 2)
        ]
    return rows


def test_the_scatter_of_one_realisation_is_that_of_the_papers_number_of_rings():
    assert PAPER_RINGS == 1000
    assert "would scatter by 0.0019." in causes_of_c(_rows(), rings=100)
    assert "would scatter by 0.0060." in causes_of_c(_rows(), rings=1000)


def test_each_cause_is_told_with_its_number():
    text = causes_of_c(_rows(), rings=100)
    assert "about transit the modulus of c is 0.0005 ± 0.0010 with the paper's facets" in text
    assert "changes c1 and c2 of these rings by −0.0005 and −0.0005" in text
    assert "0.0050 ± 0.0010 with exact ones if it begins at transit" in text
    assert "have the paper's signs with the track that ends at transit." in text


def test_the_pulls_contain_the_scatter():
    text = causes_of_c(_rows(), rings=100)
    scatter = 0.006 * math.sqrt(0.1)
    first = -0.003 / math.sqrt(0.001**2 + 0.0003**2 + scatter**2)
    second = -0.004 / math.sqrt(0.001**2 + 0.0004**2 + scatter**2)
    assert f"by {first:+.1f} and {second:+.1f} errors".replace("-", "−") in text
