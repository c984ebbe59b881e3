"""What stands on the bench: scenes, structures, effects and contact laws. Imports nothing else of vibeam's."""
