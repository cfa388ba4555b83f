"""What a wrong call raises, and what a user is warned of. What goes wrong with a source is a flag in its row."""


class InputError(ValueError):
    """A file, column or option is wrong; the message is one line: what, where, and what would be right."""


class DataWarning(UserWarning):
    """There is something about the data that a user should know although they are measured all the same."""
