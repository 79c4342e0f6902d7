"""Filters of the operator's templates."""
