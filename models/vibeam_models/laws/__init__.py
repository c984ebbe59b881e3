"""Contact laws: restitution laws and compliant stops."""
