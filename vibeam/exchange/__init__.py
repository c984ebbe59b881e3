"""File output: written whole or not at all."""
