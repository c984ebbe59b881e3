"""Several contacts: sets of them that are held or pushed as linear regimes, made when first met."""
