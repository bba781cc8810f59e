"""Pixels to observations: photographs, dots, plates, codes."""
