"""What every report is made of: a document without a format, drawings, and their writers for HTML and PDF."""
