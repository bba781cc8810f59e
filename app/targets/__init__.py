"""What is printed: plate layout, code families, drawing."""
