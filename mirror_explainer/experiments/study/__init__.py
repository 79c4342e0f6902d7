"""The paper's user study, with simulated observers and with people."""
