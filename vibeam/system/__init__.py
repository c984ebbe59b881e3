"""What passes between all parts: impact systems, drives, states, responses."""
