"""Nouns and frames: pose, similarity, camera, observations, target map, control points."""
