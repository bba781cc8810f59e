"""Observations to geometry: resection, intersection, initial network, bundle adjustment, control, calibration."""
