"""The compiled inner loops of the flight solver: pure functions on arrays, no Python objects, no global interpreter lock."""
