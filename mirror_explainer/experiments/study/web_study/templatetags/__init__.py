"""Tags of the study's templates."""
