"""Targets: one small module and one template folder each; knows no mechanics."""
