"""Stability maps over drive frequency and gap or drive amplitude."""
