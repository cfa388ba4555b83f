"""What a wrong call raises. What goes wrong with a measurement is a flag instead."""


class InputError(ValueError):
    """A file, column or option is wrong; the message is one line: what, where, and what would be right."""
