from dataclasses import fields

import numpy as np

from tests.reproduce.small_targets import check_finding, finding_of, small_target
from uvshear.reproduce.averaging_test import CASES, WIDENING, SamplingCase


def test_fine_samples_give_the_shapes_of_the_paper_s_samples():
    finding = finding_of("averaging")
    check_finding(finding, panels=1)
    changes = {
        row.name.rpartition(", ")[2]: row.as_paper.value
        for row in finding.quantities
        if row.name.startswith("rms change")
    }
    assert changes["30 kHz and 0.5 s"] < changes["1 MHz and 8 s"]


def test_the_experiments_differ_from_fine_samples_in_one_thing_each():
    fine = CASES["fine"]
    for name in ("unsmeared", "flat", "wide"):
        changed = [
            field.name
            for field in fields(SamplingCase)
            if getattr(CASES[name], field.name) != getattr(fine, field.name)
        ]
        assert len(changed) == 2  # its words, and what is changed
    assert 1.1 < WIDENING < 1.12


def test_each_experiment_changes_the_shapes_of_the_same_samples():
    target = small_target("averaging")
    measured = target.measure(next(iter(target.tasks().values())))["measured"][:, :, :2]
    shapes = {name: measured[:, way] for way, name in enumerate(CASES)}
    for name in ("unsmeared", "flat", "wide"):
        change = np.abs(shapes[name] - shapes["fine"]).max()
        assert 0 < change < 0.1
