"""The orders of the paper's baselines, over different sentences: what most robots say."""

from mirror_explainer.selection.evidence import Evidence


def increasing(evidence: Evidence) -> list[int]:
    """Return the evidence's columns in plan order, each where the plan first has its sentence."""
    return sorted(range(len(evidence.places)), key=lambda column: evidence.places[column][0])


def decreasing(evidence: Evidence) -> list[int]:
    """Return the evidence's columns from the plan's end, each where it last has its sentence."""
    return list(range(len(evidence.places)))[::-1]


ORDERS = {'increasing': increasing, 'decreasing': decreasing}
