"""Several contacts: a loop of its own on the closed forms of the compiled regimes."""
