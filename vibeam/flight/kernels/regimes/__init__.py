"""The compiled part; it takes pairs, tables and root isolation from ``vibeam.flight.kernels``."""
