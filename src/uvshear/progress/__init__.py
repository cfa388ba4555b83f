"""Progress of a long computation, which consists of stages.

A computation reports to a ``Meter``. Whoever wants to know passes a function of the work done and the total work, or an
``Observer``, which is told of the stages as well.
"""

from uvshear.progress.course import Course
from uvshear.progress.meter import Meter, Progress
from uvshear.progress.observer import Observer
from uvshear.progress.observers import Observers
from uvshear.progress.stage import Stage

__all__ = ["Course", "Meter", "Observer", "Observers", "Progress", "Stage"]
