"""What figures have in common: axes, labels that can be read, keys."""
