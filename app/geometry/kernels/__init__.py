"""Loops that vision and photogrammetry share, compiled."""
