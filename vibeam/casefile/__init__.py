"""Case files: from TOML to a case, with every fault at its line, and back."""
