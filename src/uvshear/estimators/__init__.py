"""From ellipticities to shear: takes arrays, and does not know who fitted them."""
