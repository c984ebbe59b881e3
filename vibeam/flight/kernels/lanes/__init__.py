"""Plain flights by blocks of modes in the processor's lanes."""
