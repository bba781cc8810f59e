"""Targets on paper: chosen, drawn as vectors, read back, delivered."""
