"""Three-dimensional elasticity of the rig: the rung above the beam."""
