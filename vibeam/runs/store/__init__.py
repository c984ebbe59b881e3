"""Results on disk: one HDF5 file a run, written during the run, so that a stopped run can be resumed."""
