"""The version of derive, stated in everything that it writes."""

__version__ = "0.2.0"
