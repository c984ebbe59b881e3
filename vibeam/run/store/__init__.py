"""Results on disk: one HDF5 file a run, written as it goes, so that a run that was stopped goes on where it was."""
