"""From a facet to the shape of a galaxy; nothing here knows where the facet came from.

``shape`` is the fit from beginning to end and ``measurement`` its result. ``prior`` holds what is known beforehand.
``correlator`` compares a facet with templates, ``maximum`` finds the best one, ``posterior_modes`` what else is likely,
``position`` integrates flux and position out of the likelihood, and ``posterior`` samples ellipticity and size.
``likelihood``, ``moments`` and ``metacal`` make the statistics that other estimators of the shear need;
``source_facet`` is what they see of a source. ``template``, ``normal_equations``, ``blend`` and ``neighbours`` treat
several galaxies together.
"""
