"""Data passed between all parts: impact systems, drives, states, responses."""
