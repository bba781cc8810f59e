"""What goes over the wire, each noun's shape in its own file."""
