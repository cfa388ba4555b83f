"""The only readers and writers: whatever enters or leaves is checked and converted here.

``catalogue`` and ``shapes`` are the tables of users, ``measurement_set`` and
``measurement_set_writer`` the visibilities. ``columns`` checks a user's column, ``tables`` knows
formats, ``provenance`` tells how a file was made, ``outputs`` writes it whole or not at all.
"""
