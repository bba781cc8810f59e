"""The sections of an evaluation's report."""
