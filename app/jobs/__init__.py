"""Work that leaves the event loop: the pool of worker processes and the background builds on it."""
