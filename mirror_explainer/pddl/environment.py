"""unified-planning's environment, as far as tasks need it: no planning engine is loaded.

To make one of its own, unified-planning imports its engines, and with them ConfigSpace and
scipy.stats: most of the time and memory of its import. The engines that a robot asks for run in
processes of their own.
"""

from functools import cached_property

import unified_planning.model as up
from unified_planning import environment
from unified_planning.model import walkers
from unified_planning.model.type_manager import TypeManager


class TaskEnvironment(environment.Environment):
    """An environment that makes each of its parts when it is first asked for."""

    def __init__(self) -> None:
        self.credits_stream = None
        self.error_used_name = True

    @cached_property
    def factory(self) -> object:
        """The engines; only now they are imported."""
        from unified_planning.engines import Factory

        return Factory(self)

    @cached_property
    def type_manager(self) -> TypeManager:
        """The types."""
        return TypeManager()

    @cached_property
    def type_checker(self) -> walkers.TypeChecker:
        """What tells the types of expressions."""
        return walkers.TypeChecker(self)

    @cached_property
    def expression_manager(self) -> up.ExpressionManager:
        """Every expression that was ever made."""
        return up.ExpressionManager(self)

    @cached_property
    def free_vars_oracle(self) -> up.FreeVarsOracle:
        """What tells the variables of expressions that no quantifier binds."""
        return up.FreeVarsOracle()

    @cached_property
    def simplifier(self) -> walkers.Simplifier:
        """What makes expressions simpler."""
        return walkers.Simplifier(self)

    @cached_property
    def substituter(self) -> walkers.Substituter:
        """What puts expressions in the place of others."""
        return walkers.Substituter(self)

    @cached_property
    def free_vars_extractor(self) -> walkers.FreeVarsExtractor:
        """What lists the fluents of expressions."""
        return walkers.FreeVarsExtractor()

    @cached_property
    def names_extractor(self) -> walkers.NamesExtractor:
        """What lists the names in expressions."""
        return walkers.NamesExtractor()


def use_task_environment() -> None:
    """Let unified-planning do without its engines, unless the program has begun with them."""
    if environment.GLOBAL_ENVIRONMENT is None:
        environment.GLOBAL_ENVIRONMENT = TaskEnvironment()


def forget_expressions() -> None:
    """Let unified-planning start afresh; tasks read before can't be worked with any more.

    It keeps every expression that was ever read, which a process that runs for
    weeks can't afford. (Environments of one's own are not for use: in 1.3 its reader
    and its engines still make parts of a problem in the default one.)
    """
    environment.GLOBAL_ENVIRONMENT = TaskEnvironment()
