"""Trajectories of other systems: text in many dialects -> arrays, or an error that names line and column."""
