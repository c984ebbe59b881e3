"""Number of modes that a case needs: what reductions lose, and what converges with more and more modes."""
