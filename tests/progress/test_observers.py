"""Several observers."""

from tests.progress.heard import Heard
from uvshear.progress import Meter, Observers, Stage


def test_all_observers_hear_the_same():
    one, other = Heard(), Heard()
    meter = Meter(Observers(one, other))
    meter.begin(Stage("first", 1.0, 2.0), Stage("second"))
    meter.add()
    meter.foresee(Stage("third"))
    meter.note(rms=0.1)
    meter.finish()
    assert one.all == other.all
    assert [what[0] for what in one.all] == [
        "begin",
        "advance",
        "foresee",
        "note",
        "advance",
        "finish",
    ]
