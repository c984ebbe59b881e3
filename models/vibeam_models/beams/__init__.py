"""What a beam is, as data: its sections and their shapes, stretches, bonded plates, supports."""
