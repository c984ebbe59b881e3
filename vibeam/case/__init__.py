"""Case as a record in SI units: scene, fidelities, sweep, plans, reference curves."""
