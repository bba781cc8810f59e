"""The report of an evaluation: systems beside a reference, for people and for the tool evo."""
