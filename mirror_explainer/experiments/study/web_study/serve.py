"""Serving the study, on a database that is designed before the first participant comes."""

import sys
from collections.abc import Sequence
from pathlib import Path

from mirror_explainer.errors import InputError
from mirror_explainer.experiments.study.design import PAPERS_LISTENERS, strategies_for
from mirror_explainer.experiments.study.plans import plan_scenario, plan_scenarios
from mirror_explainer.experiments.study.scenarios import scenarios
from mirror_explainer.experiments.study.warehouse_floor import read_floor
from mirror_explainer.experiments.study.web_study.database import open_database
from mirror_explainer.experiments.study.web_study.design import Design, design, practice_scenario
from mirror_explainer.experiments.study.web_study.study_file import read_study_file
from mirror_explainer.planning import Planner
from mirror_explainer.web.address import Address
from mirror_explainer.web.serving import listening, serve

SCENARIOS, SEED = 12, 0


def serve_study(
    file: Path, number: int | None, seed: int | None, address: Address, study_file: Path | None
) -> None:
    """Serve the study of a database, which is made where there is none.

    `number` of scenarios and `seed` are those of a new one; None: the study file's, or as
    usual. Raises InputError where the database's study has others, and for a study file
    with faults, PlanningError, and OSError.
    """
    study = read_study_file(study_file) if study_file else None
    listeners: Sequence[str] | None = None
    if study:
        number = study.scenarios if number is None else number
        seed = study.seed if seed is None else seed
        listeners = study.listeners

    def make() -> Design:
        listening(address).close()  # what is wrong with it is told before the planning
        return _made(number or SCENARIOS, seed or SEED, listeners or PAPERS_LISTENERS)

    found, _, key = open_database(file, make, address, study)
    others = listeners is not None and strategies_for(listeners) != found.strategies
    if number not in (None, found.drawn) or seed not in (None, found.seed) or others:
        raise InputError(
            str(file),
            f'its study has {found.drawn} scenarios of seed {found.seed}, with words for '
            f'listeners of kind {" and ".join(found.listeners)}, for good',
            cure='Name another --database for another study.',
        )
    serve(address, {'For the researcher alone': f'researcher?key={key}'})


def _made(number: int, seed: int, listeners: Sequence[str]) -> Design:
    """Draw the scenarios of a study, and plan for them."""
    strategies = strategies_for(listeners)
    if number < len(strategies):
        reason = (
            f'{number} scenarios are too few for everybody to hear {len(strategies)} strategies'
        )
        raise InputError('the study', reason, cure='Let it have more, or one listener.')
    print('user_study: preparing the scenarios, once', file=sys.stderr)
    floor = read_floor()
    planned, _ = plan_scenarios(scenarios(floor, number, seed))
    with Planner() as planner:
        practice = plan_scenario(practice_scenario(floor), planner)
    return design(seed, number, practice, planned, listeners)
