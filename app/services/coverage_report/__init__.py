"""Predicted accuracy for people and programs: a heat map over the plan, and records."""
