"""Scattermark: millimetre ground truth for indoor positioning from paper targets and photographs."""

__version__ = "0.1.0"
