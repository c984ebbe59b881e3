"""The exact engine: closed-form flight between certified impacts."""
