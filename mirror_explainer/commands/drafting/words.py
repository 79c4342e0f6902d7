"""The words of a drafted user model: the readable defaults made explicit."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from mirror_explainer.listener.english import as_verb_phrase, begins_with_verb
from mirror_explainer.listener.goal_names import GoalNames
from mirror_explainer.listener.names import Name
from mirror_explainer.listener.readable import MANNERS
from mirror_explainer.listener.sentences import DONE_TYPE, doings, sentences_for
from mirror_explainer.listener.user_model import UserModel
from mirror_explainer.listener.wording import Template, Wording, plain_name
from mirror_explainer.pddl import Task, words_of

# With more objects than this only those of the robot's plan are named.
MOST_OBJECTS = 60
# A word with its number: "hive3", but not a code such as "b12".
_NUMBERED = re.compile(r'\b([^\W\d_]{3,})(\d+)$')


@dataclass(frozen=True)
class Words:
    """How things are said: sentences by action, and what objects are called.

    The sentences of `unsure` are said better without being fixed.
    """

    sentences: Mapping[str, str]
    unsure: Mapping[str, str]
    objects: Mapping[str, str]


def drafted_words(task: Task, plan: Sequence[str]) -> Words:
    """Return how actions and objects are said now, as a user model would say the same.

    A default sentence may know more than a template can, such as which of two lifts there
    is at a place: where a step of the plan would sound otherwise it is kept apart.
    """
    default = sentences_for(task, UserModel(goals=()), plan)
    whole = doings(task)
    objects = {
        name: _task_called(known) if whole and DONE_TYPE in known.kinds else known.called()
        for name, known in default.names.items()
        if MANNERS.isdisjoint(known.kinds)  # "in infrared", not "in the infrared"
    }
    if len(objects) > MOST_OBJECTS:
        used = {word for step in plan for word in words_of(step)[1:]}
        objects = {name: called for name, called in objects.items() if name in used}
    sentences = {name: readable.sentence for name, readable in default.defaults.items()}
    sentences |= {name: template.wording.future for name, template in whole.items()}
    templates = {name: Template(Wording(text)) for name, text in sentences.items()}
    drafted = replace(default, templates=templates, objects=objects)
    unsure = {words_of(step)[0] for step in plan if drafted.of(step) != default.of(step)}
    return Words(
        {name: text for name, text in sentences.items() if name not in unsure},
        {name: text for name, text in sentences.items() if name in unsure},
        {name: _NUMBERED.sub(r'\1 \2', called) for name, called in objects.items()},
    )


def _task_called(name: Name) -> str:
    """Return what a task is called, as it stands after "I will" if it begins with a verb."""
    called = ' '.join(name.words)
    phrase = as_verb_phrase(called)
    return phrase if begins_with_verb(phrase) else called


def drafted_names(task: Task, words: Words, plan: Sequence[str]) -> GoalNames:
    """Return the names of drafted goals; none has one where two objects are called the same."""
    items = [item.name.lower() for item in task.model.all_objects]
    called = {item: words.objects.get(item, plain_name(item)) for item in items}
    are_distinct = len({*called.values()}) == len(items)
    sentences = {**words.unsure, **words.sentences} if are_distinct else {}
    return GoalNames(task, sentences, lambda _, __, item: called.get(item, item), plan)
