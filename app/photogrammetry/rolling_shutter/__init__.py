"""Photographs taken in motion by sensors that are read row by row."""
