"""First-order averaging of a one-mode system."""
