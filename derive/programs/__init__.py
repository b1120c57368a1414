"""What is generated: one row per function, each with its candidate formulations, and the cheapest tape of each."""
