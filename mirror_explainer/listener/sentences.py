"""P(O|Π)'s alphabet: the sentence that verbalizes each ground action.

Two ground actions with the same sentence are one observation to the listener. That is
the step, not its tense: "I will grab it." stands for it when it is going on or done, too.
"""

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence, Set
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import permutations

from mirror_explainer.listener.distinct import more_parameters
from mirror_explainer.listener.english import (
    as_verb_phrase,
    before_name,
    begins_with_verb,
    has_subject,
    omission,
    other_tenses,
    phrase_tenses,
    verb_parameter,
)
from mirror_explainer.listener.names import Name, heads_of, object_names, spelling
from mirror_explainer.listener.phrases import Phrases
from mirror_explainer.listener.readable import Readable, Readables
from mirror_explainer.listener.roles import Roles, roles_of
from mirror_explainer.listener.user_model import UserModel
from mirror_explainer.listener.verb_phrase import DOING
from mirror_explainer.listener.wording import Template, Wording, parts, plain_name
from mirror_explainer.pddl import Task, words_of
from mirror_explainer.pddl.progress import StepStatus

# What is of this type is done by an action `do`, whatever it is: "wash_the_cup".
DONE_TYPE = 'task'


@dataclass(frozen=True)
class Said:
    """A step as it is said: a text with parameters in braces, and what is said for each.

    `verb` is the parameter that stands for the verb and all behind it, '' if none does.
    """

    text: str
    called: Mapping[str, str]
    verb: str = ''

    @property
    def sentence(self) -> str:
        """The sentence, on one line."""
        said = with_names(self.text, self.called, has_subject(self.text))
        return ' '.join(said.split())


@dataclass(frozen=True)
class Sentences:
    """Says the ground actions of a domain.

    `templates` are the user model's, and `objects` what it calls some of the objects, by
    the name in lower case. `defaults` are the sentences of the other actions (what is in
    neither is said by its name and all of its objects), and `names` those of the objects.
    A letter or number that was said is left out of a later name where the objects that are
    `linked` to the earlier one, by action and their two parameters, are told apart without.
    """

    parameters: Mapping[str, tuple[str, ...]]
    templates: Mapping[str, Template] = field(default_factory=dict)
    objects: Mapping[str, str] = field(default_factory=dict)
    defaults: Mapping[str, Readable] = field(default_factory=dict)
    names: Mapping[str, Name] = field(default_factory=dict)
    linked: Mapping[tuple[str, str, str], Mapping[str, Set[str]]] = field(default_factory=dict)
    phrases: Phrases = field(default_factory=Phrases)

    @cached_property
    def _types(self) -> dict[str, tuple[str, ...]]:
        return {item: name.kinds for item, name in self.names.items()}

    @cached_property
    def _observations(self) -> dict[str, str]:
        """What was asked for before: many plans share their actions."""
        return {}

    def of(self, action: str) -> str:
        """Return the observation for "(grab red_circle red_room)": how it is said while ahead."""
        if action not in self._observations:
            self._observations[action] = self.worded(action, StepStatus.AHEAD).sentence
        return self._observations[action]

    def said(self, action: str, status: StepStatus) -> str:
        """Return the sentence for a ground action that is ahead, going on, done or left out."""
        return self.worded(action, status).sentence

    def verbless(self, actions: Iterable[str]) -> list[str]:
        """Return what those tasks of these actions are called whose name begins with no verb."""
        wordings = map(self._wording, dict.fromkeys(actions))
        names = [c[verb] for wording, c in wordings if (verb := verb_parameter(wording.future))]
        return [name for name in names if not begins_with_verb(as_verb_phrase(name))]

    def usual(self, name: str) -> str:
        """Return how an action of this name is said while ahead, with parameters in braces."""
        if name in self.templates:
            return self.templates[name].wording.future
        if name in self.defaults:
            return self.defaults[name].sentence
        return _by_its_name(name, self.parameters.get(name, ()))

    def called_in(self, name: str, parameter: str, item: str) -> str:
        """Return what the object of a parameter is called in the sentence of such an action."""
        if name in self.defaults and name not in self.templates and item not in self.objects:
            noun = self.defaults[name].nouns.get(parameter, '')
            return self.names[item].called((), noun, parameter in self.defaults[name].means)
        called = self._plainly(item)
        return as_verb_phrase(called) if verb_parameter(self.usual(name)) else called

    def worded(self, action: str, status: StepStatus) -> Said:
        """Return how a ground action is said."""
        wording, called = self._wording(action)
        if verb := verb_parameter(wording.future):
            return self._with_verb(wording, status, called, verb)
        return Said(in_tense(wording, status, self.phrases), called)

    def _wording(self, action: str) -> tuple[Wording, dict[str, str]]:
        """Return the wording of a ground action, and what is said for its parameters."""
        name, *arguments = words_of(action)
        parameters = self.parameters.get(name, tuple(map(str, range(len(arguments)))))
        objects = dict(zip(parameters, arguments, strict=True))
        if name in self.defaults and name not in self.templates:
            return Wording(self.defaults[name].sentence), self._called(name, objects)
        wording = Wording(_by_its_name(name, objects))
        if name in self.templates:
            wording = self.templates[name].chosen(objects, self._types)
        return wording, {p: self._plainly(o) for p, o in objects.items()}

    def _with_verb(
        self, wording: Wording, status: StepStatus, called: Mapping[str, str], verb: str
    ) -> Said:
        """Return how an action is said in whose sentence a parameter stands for the verb."""
        phrase = as_verb_phrase(called[verb])
        if not begins_with_verb(phrase):
            place = f'{{{verb}}}'
            this = replace(wording, future=wording.future.replace(place, f'do this: {place}'))
            return Said(in_tense(this, status, self.phrases), called)
        tenses = phrase_tenses(wording.future, phrase)
        text = in_tense(wording, status, self.phrases)
        inflects = status in (StepStatus.RUNNING, StepStatus.DONE)
        if tenses and inflects and text not in wording.given[1:]:
            text, phrase = tenses[0 if status is StepStatus.RUNNING else 1]
        return Said(text, {**called, verb: phrase}, verb)

    def _plainly(self, item: str) -> str:
        """Return what an object is called in a user model's sentence."""
        if item in self.objects:
            return self.objects[item]
        return ' '.join(self.names[item].words) if item in self.names else plain_name(item)

    def _called(self, action: str, objects: Mapping[str, str]) -> dict[str, str]:
        """Return what the objects of a default sentence are called, by parameter."""
        default = self.defaults[action]
        called: dict[str, str] = {}
        for p in (p for _, p in parts(default.sentence) if p):
            if objects[p] in self.objects:
                called[p] = self.objects[objects[p]]
                continue
            name = self.names[objects[p]]
            words = name.words
            for earlier in called:
                words = self._without_code(action, p, earlier, objects, words)
            called[p] = name.called(words, default.nouns.get(p, ''), p in default.means)
        return called

    def _without_code(
        self,
        action: str,
        parameter: str,
        earlier: str,
        objects: Mapping[str, str],
        words: tuple[str, ...],
    ) -> tuple[str, ...]:
        """Return a name's words without a letter or number that an earlier name has, too."""
        code = self.names[objects[earlier]].code
        others = self.linked.get((action, parameter, earlier), {}).get(objects[earlier], ())
        if len(words) < 2 or words[-1] != code:
            return words
        alike = [o for o in others if self.names[o].words[: len(words) - 1] == words[:-1]]
        return words[:-1] if alike == [objects[parameter]] else words


def sentences_for(task: Task, user_model: UserModel, plan: Sequence[str] = ()) -> Sentences:
    """Return how the actions of a task are said to this listener.

    `plan` is the robot's, as ground actions: the default sentences say as much as tells its
    steps apart.
    """
    parameters = action_parameters(task)
    templates = {**doings(task), **user_model.templates}
    every_role = roles_of(task)  # where things move tells of places in other sentences, too
    roles = {n: r for n, r in every_role.items() if n not in templates}
    facts = _static_facts(task) if roles else []
    stated: dict[str, list[str]] = {}
    for predicate, *objects in facts:
        if len(objects) == 1:
            stated.setdefault(objects[0], []).append(predicate)
    names = object_names(task, stated)
    kinds = Counter(
        kind for item, name in names.items() for kind in {*name.kinds, *stated.get(item, ())}
    )
    alone = frozenset(kind for kind, count in kinds.items() if count == 1)
    heads = heads_of(names.values())
    readables = Readables(every_role, spelling(task.written_actions), alone, heads)
    usual = Sentences(
        parameters,
        templates,
        user_model.objects,
        {name: readables.of(name) for name in roles},
        names,
        _linked(roles, facts),
        user_model.phrases,
    )

    def said(step: str, more: int) -> str:
        name = words_of(step)[0]
        return replace(usual, defaults={name: readables.of(name, more)}).of(step)

    more = more_parameters(plan, roles, said)
    return replace(usual, defaults={name: readables.of(name, more[name]) for name in roles})


def doings(task: Task) -> dict[str, Template]:
    """Return the sentences of actions that only say that a task is done: the task has the verb."""
    return {
        action.name: Template(Wording(f'I will {{{action.parameters[0].name}}}.'))
        for action in task.model.actions
        if action.name in DOING and [p.type.name for p in action.parameters] == [DONE_TYPE]
    }


def action_parameters(task: Task) -> dict[str, tuple[str, ...]]:
    """Return the parameters' names of each action of the domain."""
    return {action.name: tuple(p.name for p in action.parameters) for action in task.model.actions}


def in_tense(wording: Wording, status: StepStatus, phrases: Phrases) -> str:
    """Return a wording's text for a step that is ahead, going on, done or left out."""
    if status is StepStatus.AHEAD:
        return wording.future
    if status is StepStatus.SKIPPED:
        left_out = phrases.skipped.replace('{sentence}', wording.future)
        return omission(wording.future) or left_out
    given = wording.present if status is StepStatus.RUNNING else wording.past
    if given:
        return given
    if made := other_tenses(wording.future):
        return made[0] if status is StepStatus.RUNNING else made[1]
    if status is StepStatus.RUNNING:
        return wording.future
    return phrases.already.replace('{sentence}', wording.future)


def with_names(text: str, called: Mapping[str, str], is_english: bool = True) -> str:
    """Return a text with what is said for each parameter; English has the article it wants."""
    said = []
    for before, parameter in parts(text):
        name = called[parameter] if parameter else ''
        said += [before_name(before, name) if is_english and name else before, name]
    return ''.join(said)


def _by_its_name(action: str, parameters: Iterable[str]) -> str:
    """Return how an action is said of which only its name and parameters are known."""
    places = (f'{{{parameter}}}' for parameter in parameters)
    return f'I will {" ".join([plain_name(action), *places])}.'


def _static_facts(task: Task) -> list[tuple[str, ...]]:
    """Return predicate and objects of what holds initially and never changes."""
    static = task.model.get_static_fluents()
    return [
        (atom.fluent().name, *(str(argument).lower() for argument in atom.args))
        for atom, value in task.model.explicit_initial_values.items()
        if atom.fluent() in static and value.is_true()
    ]


def _linked(
    roles: Mapping[str, Roles], facts: Sequence[tuple[str, ...]]
) -> dict[tuple[str, str, str], dict[str, set[str]]]:
    """Return, by action and two parameters, the first one's objects for one of the second's.

    They are those that a static precondition allows, such as the floors of a lift.
    """
    by_predicate: dict[str, list[tuple[str, ...]]] = {}
    for fact in facts:
        by_predicate.setdefault(fact[0], []).append(fact[1:])
    linked: dict[tuple[str, str, str], dict[str, set[str]]] = {}
    for role in roles.values():
        for atom in role.needed:
            for i, j in permutations(range(len(atom.arguments)), 2):
                pair = role.name, atom.arguments[i], atom.arguments[j]
                if all(pair) and atom.predicate in by_predicate:
                    allowed = linked.setdefault(pair, {})
                    for objects in by_predicate[atom.predicate]:
                        allowed.setdefault(objects[j], set()).add(objects[i])
    return linked
