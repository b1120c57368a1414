"""Where lines break, and how much of a closed form is printed."""
