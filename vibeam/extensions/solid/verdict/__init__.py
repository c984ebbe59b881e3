"""The beam against the solid of the same rig: whether it is enough, and which of its assumptions is not."""
