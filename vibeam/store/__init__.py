"""Files that survive: blocks, sealed HDF5, the lock of their one writer."""
