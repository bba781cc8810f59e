"""Photographs without the place where they were taken: metadata is rewritten, compressed pixels are never touched."""
