"""The stability map of a case: frequency against gap or drive, for each model that its fidelities make."""
