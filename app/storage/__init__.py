"""Domain objects in the database and photographs on disk; rows never leave this folder."""
