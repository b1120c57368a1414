"""What the commands do, from Python: one module per task, documented results instead of printed ones.

`derive` itself shows the functions: ``derive.build("scara-perugia")``. They are imported when they are asked for.
"""
