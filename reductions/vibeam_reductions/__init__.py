"""How a structure is made smaller. Imports ``vibeam_models`` only."""
