"""Numerical methods without reference to telescopes or galaxies.

``fft_sizes`` finds lengths that transform quickly, ``half_plane`` lists the cells of half of a uv plane, ``symmetric``
treats symmetric matrices that rounding has left slightly indefinite, and ``damped_newton`` climbs to a maximum.
"""
