"""One module per command: its arguments (``configure``) and what it does (``run``), without any mathematics.

Heavy imports stay inside ``run``, so that ``derive --help`` answers at once.
"""
