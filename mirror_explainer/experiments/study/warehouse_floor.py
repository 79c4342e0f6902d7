"""The floor of the user study's scenarios: that of the warehouse example."""

from mirror_explainer.experiments.study.scenarios import Floor, floor
from mirror_explainer.experiments.warehouse_files import read_warehouse


def read_floor() -> Floor:
    """Read the floor that the scenarios of the user study take place on."""
    return floor(*read_warehouse())
