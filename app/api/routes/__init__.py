"""Endpoints: a signature, one call, a return."""
