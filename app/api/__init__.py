"""HTTP only: routes, schemas, one table of errors."""
