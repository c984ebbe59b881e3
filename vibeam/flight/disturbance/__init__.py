"""Small disturbances of a motion, and its time derivatives."""
