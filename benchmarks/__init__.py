"""Accuracy and speed of the library against a room with truth; each prints a table and writes JSON."""
