"""The operator's page as a site: what it needs of whoever talks to the explainer."""

from dataclasses import dataclass
from typing import Protocol

from mirror_explainer.web.operator.heard import Heard
from mirror_explainer.web.site import Site


class Explainer(Protocol):
    """An explainer as the page uses it: every call returns in limited time.

    What goes wrong is no exception, but heard as a failure.
    """

    def heard(self) -> Heard:
        """Return what was heard, up to now."""

    def ask(self) -> None:
        """Ask what the robot is up to, and wait until the answer is heard."""

    def adjust(self, *, n: int, strategy: str) -> bool:
        """Set how many sentences an answer has and how they are chosen; whether that was done."""

    def forget(self) -> None:
        """Let the explainer forget what it said."""

    def restart(self) -> None:
        """Let the demo robot begin again."""


@dataclass(frozen=True, kw_only=True)
class OperatorSite(Site):
    """The site with its explainer, which views find in Django's settings."""

    explainer: Explainer


def operator_site(explainer: Explainer, namespace: str) -> OperatorSite:
    """Return the page of the explainer in a ROS namespace, such as `/robot1`."""
    name = 'operator' + namespace.rstrip('/').replace('/', '_')
    return OperatorSite(name, 'mirror_explainer.web.operator', explainer=explainer)
