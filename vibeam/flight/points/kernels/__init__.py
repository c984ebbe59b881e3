"""Kernels of independent points side by side in the processor's lanes."""
