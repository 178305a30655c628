"""What is drawn: one page a file, and the parts that they share."""
