import json
from dataclasses import replace

import pytest
from matplotlib.figure import Figure

from uvshear.errors import InputError
from uvshear.io.outputs import write_json
from uvshear.reproduce.finding import Estimate, Finding, Quantity
from uvshear.reproduce.psf_images import PsfImages
from uvshear.reproduce.reproduced_target import ReproducedTarget

FINDING = Finding(
    (Quantity("m1", Estimate(0.1, 0.02), Estimate(0.11), None),), Figure(), "A caption.", ("One.",)
)


def test_what_is_written_is_read_again(tmp_path):
    target = ReproducedTarget.from_finding(PsfImages(3), "quick", FINDING, 12.5)
    path = tmp_path / "psf-images.json"
    write_json(path, target.record())
    assert ReproducedTarget.read(path) == target
    write_json(path, target.record() | {"commit": "0123456789"}, overwrite=True)
    assert ReproducedTarget.read(path) == replace(target, commit="0123456789")


@pytest.mark.parametrize("record", [{}, {"target": "psf-images"}, {"quantities": 3}])
def test_another_file_is_refused(tmp_path, record):
    path = tmp_path / "psf-images.json"
    path.write_text(json.dumps(record))
    with pytest.raises(InputError, match="is not the record of a reproduced target"):
        ReproducedTarget.read(path)
