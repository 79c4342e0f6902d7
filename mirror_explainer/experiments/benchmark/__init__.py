"""The paper's benchmark: the PUCRS problems."""
