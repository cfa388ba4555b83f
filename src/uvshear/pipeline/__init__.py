"""The measurement from end to end: ``simulate``, ``measure``, and from a ``Measurement`` to a shear."""
