"""Linear identification: natural frequency, damping and gain of one mode; keys of a case from measured modes."""
