"""Loops over targets and dots, compiled: each file one step of a resection."""
