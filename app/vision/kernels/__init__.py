"""Loops over pixels and candidates, compiled: each file one step of the default detector."""
