"""The version of derive, stated in everything that it writes."""

__version__ = "0.1.0"
