"""C99: functions, kernels and files."""
