"""The exception of wrong inputs and the warning about data. The failure of a single source is a flag in its row."""


class InputError(ValueError):
    """A file, column or option is wrong; the message is one line: what, where, and what would be right."""


class DataWarning(UserWarning):
    """Fact about the data that a user should know, although it does not prevent their measurement."""
