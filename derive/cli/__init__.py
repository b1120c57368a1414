"""One module per command: its arguments (``configure``) and what it does (``run``), without any mathematics."""
