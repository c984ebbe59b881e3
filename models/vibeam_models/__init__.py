"""Models of the rig: scenes, structures, effects and contact laws. Imports nothing else of vibeam's."""
