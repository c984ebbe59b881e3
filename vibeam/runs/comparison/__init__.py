"""Comparison of fidelities: what it holds fixed, what the other choice gives, how far the finest is from its limit."""
