"""Linear regimes in block form: eigenpairs, blocks, propagators."""
