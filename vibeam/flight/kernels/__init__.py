"""The compiled inner loops of the flight solver: functions on arrays, no Python objects, no interpreter lock."""
