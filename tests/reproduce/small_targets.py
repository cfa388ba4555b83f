"""Targets with so few galaxies that they run within seconds, and what they find."""

from dataclasses import replace
from functools import cache

from uvshear.reproduce.finding import Finding
from uvshear.reproduce.paper_pointing import PaperPointing
from uvshear.reproduce.paper_target import PaperTarget
from uvshear.reproduce.registry import targets_at

FEW = {
    "galaxies": 4,
    "block": 2,
    "with_cells": 2,
    "pairs": 3,
    "rings": 2,
    "tracked": 4,
    "fewer": 2,
    "samples": 30_000,
}
INTEGRATION = 7200.0


def small_target(name: str, **options) -> PaperTarget:
    """Return a target with a few galaxies and a coarse track."""
    (target,) = targets_at("quick", (name,))
    known = set(type(target).__dataclass_fields__)
    settings = {key: value for key, value in FEW.items() if key in known}
    if "integration" in known:
        settings["integration"] = INTEGRATION
    if "pointing" in known and name != "averaging":
        settings["pointing"] = PaperPointing(integration=INTEGRATION)
    return replace(target, **(settings | options))


def run(target: PaperTarget) -> Finding:
    """Compute all parts of a target in this process, and return its finding."""
    return target.finding({name: target.measure(task) for name, task in target.tasks().items()})


@cache
def finding_of(name: str) -> Finding:
    """Return what a small target finds."""
    return run(small_target(name))


def check_finding(finding: Finding, panels: int) -> None:
    """Raise unless the finding has rows with different names, a picture with labels, and a caption."""
    names = [quantity.name for quantity in finding.quantities]
    assert len(set(names)) == len(names)
    assert len(finding.picture.axes) == panels
    for ax in finding.picture.axes:
        assert ax.get_xlabel()
        assert ax.get_ylabel()
    assert finding.caption.endswith(".")
    assert all(remark.endswith(".") for remark in finding.remarks)
