"""How far an estimator of the shear is from the truth: galaxies of known shear, many times."""
