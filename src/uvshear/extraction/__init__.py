"""What belongs to one source, cut out of the visibilities of all.

``schedule`` says which sources may be worked on side by side, ``visit`` reads the visibilities once, subtracts
everything modelled and feeds the facets. A way of making facets is one module: ``exact`` (dirty cutout and dirty
beam), ``cell_average`` (Rivi & Miller 2018), both behind ``facets``. Nothing here knows how a facet is fitted.
"""
