"""The exception of wrong inputs and the warning about data. The failure of a single source is a flag in its row."""


class InputError(ValueError):
    """A file, column or option is wrong; the message is one line: what, where, and what would be right."""


class DataWarning(UserWarning):
    """Warning of something in the data that a user should know, but that does not prevent a measurement."""


class NothingMeasuredWarning(DataWarning):
    """No galaxy could be measured; the message says why that is likely."""


class CheckpointWarning(DataWarning):
    """A measurement has no state to go on from, or cannot store its state; the work goes on all the same."""
