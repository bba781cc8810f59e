"""Before a target is printed or posted: synthetic photographs, predicted accuracy, coverage."""
