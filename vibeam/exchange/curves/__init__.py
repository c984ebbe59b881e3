"""Measured curves in files of others: text, MATLAB, HDF5, universal files."""
