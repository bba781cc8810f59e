"""Numbers that say how far a system's positions are from the reference."""
