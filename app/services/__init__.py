"""One file per story; whoever calls brings a database session, a photo store or a pool of workers."""
