"""The command line: one module per command, with its arguments (``configure``) and what it prints (``run``).

`main` reads the arguments and turns errors into messages and exit statuses, `terminal` writes. What a command does is
in `derive.api`; there is no mathematics here. Modules import what they need when they run: help answers at once.
"""
