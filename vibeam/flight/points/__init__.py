"""Many independent points of plain systems: packed together, side by side in the processor's lanes."""
