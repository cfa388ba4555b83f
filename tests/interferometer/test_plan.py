"""Plans of observations."""

from tests.interferometer.chunks import CENTRE
from uvshear.interferometer.coverage import Track
from uvshear.interferometer.layout import load_layout
from uvshear.interferometer.plan import ObservingPlan
from uvshear.interferometer.spectral_window import Channels


def test_a_plan_takes_single_times_and_frequencies_unless_told():
    track = Track.from_clock(CENTRE, ((-60.0, 60.0),), 60.0)
    plan = ObservingPlan(load_layout("vla-b"), track, Channels.from_band(1e9, 1.1e9, 2))
    assert not plan.is_averaged
    assert plan.primary_beam is None
