"""Poses over time."""
