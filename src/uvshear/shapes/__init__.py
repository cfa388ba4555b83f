"""From a facet to a shape: nothing here knows where the facet came from.

``correlator`` compares the facet with templates, ``maximum`` finds the best one, ``position`` takes flux and
position out of the likelihood, ``posterior`` samples what is left over ellipticity and size, ``shape`` strings
them together, ``measurement`` is what comes out.
"""
