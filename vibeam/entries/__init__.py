"""What one key of a case may hold: each entry reads a value, refuses what it cannot be, and describes itself."""
