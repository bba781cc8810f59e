"""What the report shows: drawings without a format."""
