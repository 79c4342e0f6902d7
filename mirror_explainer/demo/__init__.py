"""A small robot for trying the package out."""
