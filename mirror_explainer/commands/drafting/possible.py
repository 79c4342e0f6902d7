"""What of a robot's world may be otherwise, by the looks of its domain and its plans."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import unified_planning.model as up

from mirror_explainer.commands.drafting.patterns import World, type_name
from mirror_explainer.pddl import conjuncts, words_of
from mirror_explainer.pddl.atoms import effects_in


@dataclass(frozen=True)
class Possible:
    """Looks at the domain for facts that may be otherwise."""

    world: World
    goals: Sequence[tuple[str, ...]]

    @cached_property
    def _model(self) -> up.Problem:
        return self.world.task.model

    @cached_property
    def _initial(self) -> frozenset[str]:
        return self.world.task.initial_facts

    @cached_property
    def _aimed_at(self) -> set[str]:
        """The predicates of goals: that one is reached already is no doubt about the world."""
        return {words_of(part.replace('(not ', ''))[0] for goal in self.goals for part in goal}

    def needed(self, plan: Iterable[str]) -> Iterator[str]:
        """Yield what holds initially and an action of a plan needs: of one object at most.

        Of more objects only what actions change: a map is not doubted.
        """
        for step in plan:
            for atom in self._conditions(step):
                if atom in self._initial and self._may_be_doubted(atom):
                    yield atom

    def made(self, plan: Iterable[str]) -> Iterator[str]:
        """Yield what does not hold, a step of a plan brings about, and a later one needs.

        Of these only what may hold beside the rest, as `absent` does; and of more than one object
        only what holds of others, as a gate may be open: the rest is the robot's own work.
        """
        usual = {words_of(fact)[0] for fact in self._initial}
        brought: set[str] = set()
        for step in plan:
            for atom in (a for a in self._conditions(step) if a in brought):
                predicate, *objects = words_of(atom)
                is_work = len(objects) > 1 and predicate not in usual
                if not is_work and self._may_be_doubted(atom) and self._free(atom):
                    yield atom
            brought |= set(self._effects(step, True)) - self._initial

    def _undone(self, plan: Iterable[str]) -> Iterator[str]:
        """Yield what holds initially and a plan undoes."""
        for step in plan:
            yield from (atom for atom in self._effects(step, False) if atom in self._initial)

    def _conditions(self, step: str) -> Iterator[str]:
        """Yield the atoms that the literals of a step's precondition are about."""
        action, bound = self._bound(step)
        for condition in action.preconditions:
            yield from (_ground(part, bound) for part in conjuncts(condition))

    def _effects(self, step: str, value: bool) -> Iterator[str]:
        """Yield the atoms that a step makes true, or false."""
        action, bound = self._bound(step)
        for effect in effects_in(action):
            if effect.value.is_true() if value else effect.value.is_false():
                yield _ground(effect.fluent, bound)

    def _bound(self, step: str) -> tuple[up.Action, dict[str, str]]:
        name, *objects = words_of(step)
        action = self._model.action(name)
        return action, {p.name: o for p, o in zip(action.parameters, objects, strict=True)}

    def together(self, atom: str) -> set[str]:
        """Return the other atoms of this one's predicate that change whenever it does."""
        changed = []
        for action in self._model.actions:
            for effect in effects_in(action):
                bound = self._matched(effect.fluent, atom)
                if bound is not None:
                    alike = (e.fluent for e in effects_in(action) if e.value == effect.value)
                    changed.append({_ground(fluent, bound) for fluent in alike})
        common = set.intersection(*changed) if changed else set()
        common -= {'', atom}
        return {other for other in common if words_of(other)[0] == words_of(atom)[0]}

    def _matched(self, fluent: up.FNode, atom: str) -> dict[str, str] | None:
        """Return the objects of an effect's parameters that make it this atom's, if any do."""
        predicate, *objects = words_of(atom)
        if fluent.fluent().name.lower() != predicate:
            return None
        bound: dict[str, str] = {}
        for argument, item in zip(fluent.args, objects, strict=True):
            if not argument.is_parameter_exp():
                if str(argument).lower() != item:
                    return None
                continue
            parameter = argument.parameter()
            of_type = self.world.of_type[type_name(parameter)]
            if item not in of_type or bound.get(parameter.name, item) != item:
                return None
            bound[parameter.name] = item
        return bound

    def _may_be_doubted(self, atom: str) -> bool:
        predicate, *objects = words_of(atom)
        if predicate in self._aimed_at | self.world.task.stand_ins:
            return False
        return len(objects) <= 1 or predicate in self.world.changing

    def absent(self) -> Iterator[str]:
        """Yield what does not hold, an action can bring about, and another needs.

        Not where bringing it about undoes something that holds: the two exclude each other.
        """
        needed = {
            atom.fluent().name
            for action in self._model.actions
            for condition in action.preconditions
            for atom in conjuncts(condition)
            if atom.is_fluent_exp()
        }
        for fluent in self._model.fluents:
            if not fluent.type.is_bool_type() or fluent.arity > 1 or fluent.name not in needed:
                continue
            kinds = [parameter.type for parameter in fluent.signature]
            choices = [[o.name.lower()] for o in self._model.objects(kinds[0])] if kinds else [[]]
            for objects in choices:
                atom = f'({" ".join([fluent.name.lower(), *objects])})'
                if atom not in self._initial and self._may_be_doubted(atom) and self._free(atom):
                    yield atom

    def _free(self, atom: str) -> bool:
        """Say whether some action brings an atom about and undoes nothing that holds."""
        for action in self._model.actions:
            effects = effects_in(action)
            undone = [effect.fluent for effect in effects if effect.value.is_false()]
            for effect in effects:
                bound = self._matched(effect.fluent, atom) if effect.value.is_true() else None
                if bound is not None and not any(self._holds_some(f, bound) for f in undone):
                    return True
        return False

    def _holds_some(self, fluent: up.FNode, bound: Mapping[str, str]) -> bool:
        """Say whether a fact of this form holds, whatever the other parameters are."""
        form = [
            bound.get(a.parameter().name) if a.is_parameter_exp() else str(a).lower()
            for a in fluent.args
        ]
        name = fluent.fluent().name.lower()
        return any(
            words[0] == name and all(f in (None, w) for f, w in zip(form, words[1:], strict=True))
            for words in map(words_of, self._initial)
        )

    @cached_property
    def _named(self) -> frozenset[str]:
        """The objects that the robot's goal names."""
        words = (word for part in self.goals[0] for word in words_of(part))
        return frozenset(word for word in words if word in self.world.types)

    def is_named(self, group: Sequence[str]) -> bool:
        """Say whether the robot's goal names the thing whose places a group tells."""
        thing = set(words_of(group[0])[1:]).intersection(words_of(group[1])[1:])
        return not self._named.isdisjoint(thing)

    def places(self, plan: Sequence[str]) -> Iterator[tuple[str, ...]]:
        """Yield, for each thing of the robot's, where it is and where others like it are.

        These are the things that its goal names, and those that its plan takes away from where
        they are. A place is told by a fact of two objects that actions change, with one for
        each thing.
        """
        taken = frozenset(self._undone(plan))
        by_predicate: dict[str, list[list[str]]] = {}
        for predicate, *objects in map(words_of, sorted(self._initial)):
            if len(objects) == 2 and predicate in self.world.changing - self._aimed_at:
                by_predicate.setdefault(predicate, []).append(objects)
        for predicate, pairs in by_predicate.items():
            for thing, place in ((0, 1), (1, 0)):
                named = [pair[thing] for pair in pairs]
                where = list(dict.fromkeys(pair[place] for pair in pairs))
                if len(set(named)) < len(named) or len(where) < 2:
                    continue
                for pair in pairs:
                    own = pair[place]
                    ordered = [own, *(other for other in where if other != own)]
                    group = tuple(_at(predicate, pair, place, other) for other in ordered)
                    if pair[thing] in self._named or group[0] in taken:
                        yield group


def _at(predicate: str, pair: Sequence[str], place: int, other: str) -> str:
    objects = [other if position == place else item for position, item in enumerate(pair)]
    return f'({predicate} {" ".join(objects)})'


def _ground(condition: up.FNode, bound: Mapping[str, str]) -> str:
    """Return the atom that a literal is about, '' for another condition or an unknown object."""
    atom = condition.arg(0) if condition.is_not() else condition
    if not atom.is_fluent_exp():
        return ''
    words = [
        bound.get(a.parameter().name, '') if a.is_parameter_exp() else str(a).lower()
        for a in atom.args
    ]
    if not all(words):
        return ''
    return f'({" ".join([atom.fluent().name.lower(), *words])})'
