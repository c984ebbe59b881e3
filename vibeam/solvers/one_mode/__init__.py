"""One-mode system in the paper's variables, and solvers of its stationary motions."""
