"""Worker of the fast way: Fast Downward, grounded once for all beliefs of a space.

Run by its path by `worker.py`. It is the only program here that imports the
translator; the searches are processes of its own group.
"""

import gc
from collections.abc import Sequence
from dataclasses import replace

from mirror_explainer.errors import PlanningError
from mirror_explainer.planning.beliefs import Belief, Cut
from mirror_explainer.planning.downward.further_plans import FurtherPlans
from mirror_explainer.planning.downward.grounding import translator
from mirror_explainer.planning.downward.grounding.ground_once import Grounding
from mirror_explainer.planning.downward.grounding.pddl_lists import Lists, UnfitError
from mirror_explainer.planning.downward.grounding.translations import Translations
from mirror_explainer.planning.downward.program import downward, kstar
from mirror_explainer.planning.downward.searches import Searches
from mirror_explainer.planning.downward.subject import Subjects
from mirror_explainer.planning.downward.superset_walk import SupersetWalk
from mirror_explainer.planning.messages import Ask, Attempt, Done, EndSearches, Refusal, Unfitting
from mirror_explainer.planning.processes.child import Parent
from mirror_explainer.planning.processes.confinement import limit_memory


class DownwardWorker:
    """Serves a parent, and keeps the last grounding as long as it is right."""

    def __init__(self, parent: Parent) -> None:
        self._parent = parent
        self._grounded: tuple[Lists, Grounding | str] | None = None

    def serve(self) -> None:
        """Answer the parent until it ends this process."""
        while True:
            message = self._parent.receive()
            if isinstance(message, Ask):
                limit_memory(message.resources.memory_limit)
                self._parent.send(self._answer(message))

    def _answer(self, ask: Ask) -> Done | Unfitting | Refusal:
        def report(beliefs: Sequence[Belief], attempt: Attempt) -> None:
            self._parent.send([(belief, attempt) for belief in beliefs])

        searches = Searches(ask, report)
        try:
            subjects, way = self._subjects(ask)
            self._parent.send([])
            listening = self._parent.fileno(), self._stopped
            finished = searches.run(subjects, downward(ask.downward), *listening)
            if finished and ask.plans_per_belief > 1 and ask.kstar:
                walks = [walk for walk in subjects if isinstance(walk, SupersetWalk)]
                further = [FurtherPlans(walk, ask.plans_per_belief) for walk in walks]
                searches.run(further, kstar(ask.kstar), *listening)
        except PlanningError as error:
            return Refusal(str(error), error.cure)
        except MemoryError:
            return Refusal(
                f'the problem does not fit into {ask.resources.memory_limit} MiB',
                'Raise planner_memory_limit.',
            )
        except OSError as error:  # the computer's fault, not the texts'
            return Refusal(
                f'planning does not get what it needs of the system: {error}',
                'Free memory, or allow more processes and open files.',
            )
        except UnfitError as error:
            return Unfitting(str(error))
        except Exception as error:  # a fault here, or a translator that has changed inside
            return Unfitting(f'{type(error).__name__}: {error}', unexpected=True)
        return Done(searches.calls, searches.searching, way, searches.worked)

    def _stopped(self) -> bool:
        return isinstance(self._parent.receive(), EndSearches)

    def _subjects(self, ask: Ask) -> tuple[list[Subjects], str]:
        """Return what to plan for, and how in a few words."""
        lists = translator.parse(ask.space)
        grounding, way = self._grounding(lists)
        if isinstance(grounding, str):
            singles = Translations(lists, ask.space, ask.beliefs)
            return [singles], f'each belief translated by itself: {grounding}'
        together = [b for b in ask.beliefs if b.goal not in grounding.hard_goals]
        alone = [b for b in ask.beliefs if b.goal in grounding.hard_goals]
        initial = translator.initial_atoms(lists)
        cut: Cut = '' if ask.plans_per_belief == 1 else 'time' if ask.kstar else 'planner'
        return [
            SupersetWalk(grounding, initial, together, lists.scale, cut),
            Translations(lists, ask.space, alone),
        ], way

    def _grounding(self, lists: Lists) -> tuple[Grounding | str, str]:
        """Return the last grounding if it is right for these texts, or ground anew."""
        if self._grounded:
            known, grounding = self._grounded
            same = replace(known, initial_facts=()) == replace(lists, initial_facts=())
            initial = translator.initial_atoms(lists)
            if same and isinstance(grounding, Grounding) and grounding.holds_for(initial):
                return grounding, 'grounding kept'
        # It is made of a great many objects, which are all kept: it took a fifth of its time to
        # look so often for those that are not.
        gc.disable()
        try:
            grounding = translator.ground(lists)
        finally:
            gc.enable()
        self._grounded = lists, grounding
        return grounding, 'grounded once'


def main() -> None:
    """Serve the parent until it ends this process."""
    DownwardWorker(Parent()).serve()


if __name__ == '__main__':
    main()
