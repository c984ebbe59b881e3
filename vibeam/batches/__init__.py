"""Many independent steady points at once: arrays in, arrays out."""
