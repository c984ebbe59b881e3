"""Tangent maps of a motion in compiled code: flows of every regime, integrated contact, what happens at events."""
