"""What a task declares: its types, objects, predicates and functions, and where.

Equal declarations count once. Raised is InputError with the line of what is wrong.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field

from mirror_explainer.errors import InputError, did_you_mean
from mirror_explainer.pddl.text.definition import Definition, unequal
from mirror_explainer.pddl.text.tree import Branch, Tree, Word, as_text, require_name, word

OBJECT = 'object'
# What a predicate cannot be called, since conditions and effects mean something else by it.
RESERVED = frozenset(
    [
        'and',
        'or',
        'not',
        'imply',
        'forall',
        'exists',
        'when',
        'preference',
        'increase',
        'decrease',
        'assign',
        'either',
        '=',
        '>',
        '<',
        '>=',
        '<=',
        '+',
        '-',
        '*',
        '/',
    ]
)

# The types of a variable or object, of which (either …) names several.
Kinds = tuple[str, ...]


@dataclass(frozen=True)
class Declared:
    """A predicate or function: its parameters by name, with the question mark, and types."""

    name: Word
    parameters: tuple[tuple[str, Kinds], ...]


@dataclass(frozen=True)
class Declarations:
    """All that a task declares, by name.

    `types` has each type's supertypes, `object` has none. `objects` are the domain's constants
    and the problem's objects, `written` says how they are written.
    """

    types: Mapping[str, Kinds]
    objects: Mapping[str, Kinds]
    predicates: Mapping[str, Declared]
    functions: Mapping[str, Declared]
    written: Mapping[str, str] = field(default_factory=dict, repr=False)

    def above(self, name: str) -> frozenset[str]:
        """Return a type with all types above it."""
        found, waiting = {name}, [name]
        while waiting:
            new = set(self.types.get(waiting.pop(), ())) - found
            found |= new
            waiting += new
        return frozenset(found)

    def extent(self, kinds: Kinds) -> list[str]:
        """Return the objects that have one of the types."""
        below = {name for name in self.types if self.above(name) & set(kinds)}
        return [name for name, own in self.objects.items() if below & set(own)]


def read_declarations(domain: Definition, problem: Definition) -> Declarations:
    """Return what the two declare together."""
    types = _types(domain)
    predicates = _declared(domain, ':predicates', types)
    functions = _declared(domain, ':functions', types)
    for name, function in functions.items():
        if name in predicates:
            raise InputError(
                domain.source,
                f'"{name}" is both a predicate (on line {predicates[name].name.line}) and a '
                'function',
                function.name.line,
                cure='Rename one of them.',
            )
    objects: dict[str, tuple[Word, Kinds]] = {}
    for definition, keyword in ((domain, ':constants'), (problem, ':objects')):
        for name, kinds in typed_names(definition.contents(keyword), definition.source):
            if name.startswith('?'):
                raise InputError(definition.source, f'{name} is a variable, no object', name.line)
            require_types(kinds, types, definition.source)
            held = tuple(dict.fromkeys(kinds))
            if name in objects and set(objects[name][1]) != set(held):
                raise unequal(f'the object "{name}"', objects[name][0], name, definition.source)
            objects.setdefault(name, (name, held))
    return Declarations(
        types,
        {name: tuple(map(str, kinds)) for name, (_, kinds) in objects.items()},
        predicates,
        functions,
        {name: word.written for name, (word, _) in objects.items()},
    )


def typed_names(parts: Sequence[Tree], source: str) -> list[tuple[Word, tuple[Word, ...]]]:
    """Return each name of "a b - type c - (either type type)" with its types; none is object."""
    found: list[tuple[Word, tuple[Word, ...]]] = []
    names: list[Word] = []
    rest = iter(parts)
    for part in rest:
        if isinstance(part, Word) and part[0] == '-' and len(part) > 1 and names:
            short = word(part[1:], part)  # "?x -type", with a blank forgotten
            found += [(name, (short,)) for name in names]
            names = []
            continue
        if not isinstance(part, Word):
            raise InputError(
                source, f'"{as_text(part)[:60]}" stands where a name is expected', part.line
            )
        if part != '-':
            if part.startswith(':'):
                reason = f'"{part}" stands where a name is expected: is a parenthesis missing?'
                raise InputError(source, reason, part.line)
            require_name(word(part[1:], part) if part.startswith('?') else part, source)
            names.append(part)
            continue
        kind = next(rest, None)
        if not names or kind is None or kind == '-':
            missing = 'a name before this "-"' if not names else 'a type after this "-"'
            if not names and found:
                name, kinds = found[-1]
                missing = f'the type of {name}, or a name after "{name} - {kinds[-1]}",'
            raise InputError(source, f'{missing} is missing', part.line)
        kinds = _kinds(kind, source)
        found += [(name, kinds) for name in names]
        names = []
    return found + [(name, (word(OBJECT, name),)) for name in names]


def typed_variables(
    tree: Tree | None, types: Mapping[str, Kinds], source: str, what: str, line: int
) -> dict[str, Kinds]:
    """Return the variables of a parenthesis, with the question mark, by name."""
    if not isinstance(tree, Branch):
        raise InputError(source, f'{what} takes its variables in parentheses', line)
    found: dict[str, Kinds] = {}
    for name, kinds in typed_names(tree, source):
        if not name.startswith('?'):
            reason = f'"{name}" stands where {what} takes a variable, such as ?x'
            raise InputError(source, reason, name.line)
        if name in found:
            raise InputError(source, f'{what} has the variable {name} twice', name.line)
        require_types(kinds, types, source)
        found[str(name)] = tuple(map(str, kinds))
    return found


def require_types(kinds: Iterable[Word], types: Mapping[str, Kinds], source: str) -> None:
    """Raise InputError for the first type that is not declared."""
    for kind in kinds:
        if kind not in types:
            hint = did_you_mean(kind, types)
            raise InputError(source, f'the type "{kind}" is not declared{hint}', kind.line)


def _kinds(kind: Tree, source: str) -> tuple[Word, ...]:
    if isinstance(kind, Word):
        return (kind,)
    names = tuple(name for name in kind[1:] if isinstance(name, Word))
    if kind.head != 'either' or len(names) != len(kind) - 1 or not names:
        raise InputError(
            source, f'"{as_text(kind)[:60]}" is no type, nor (either type type)', kind.line
        )
    return names


def _types(domain: Definition) -> dict[str, Kinds]:
    """Return the supertypes of each type; what is only named as a supertype is declared, too."""
    parents: dict[str, dict[str, None]] = {}
    places: dict[str, Word] = {}
    for name, kinds in typed_names(domain.contents(':types'), domain.source):
        places.setdefault(name, name)
        parents.setdefault(str(name), {}).update(dict.fromkeys(map(str, kinds)))
    for above in [*parents.values()]:
        for kind in above:
            parents.setdefault(kind, {OBJECT: None})
    parents.pop(OBJECT, None)
    for above in parents.values():
        if len(above) > 1:  # object is above all others
            above.pop(OBJECT, None)
    found: dict[str, Kinds] = {OBJECT: ()} | {k: tuple(above) for k, above in parents.items()}
    types = Declarations(found, {}, {}, {})
    for kind in found:
        if any(kind in types.above(above) for above in found[kind]):
            circle = [f'"{k}"' for k in sorted(types.above(kind)) if kind in types.above(k)]
            raise InputError(
                domain.source,
                f'the type {circle[0]} is declared as a subtype of itself'
                if len(circle) == 1
                else f'the types {", ".join(circle)} are declared as subtypes of each other',
                places[kind].line if kind in places else None,
            )
    # Of the supertypes, those that are above others say nothing.
    return {
        kind: tuple(k for k in above if not any(k in types.above(o) for o in above if o != k))
        for kind, above in found.items()
    }


def _declared(domain: Definition, keyword: str, types: Mapping[str, Kinds]) -> dict[str, Declared]:
    """Return the predicates or functions."""
    found: dict[str, Declared] = {}
    source = domain.source
    parts = iter(domain.contents(keyword))
    what = 'predicate' if keyword == ':predicates' else 'function'
    for part in parts:
        if part == '-' and keyword == ':functions':
            kind = next(parts, None)
            if kind != 'number':
                raise InputError(
                    source,
                    f'functions are read as numbers, not as "{as_text(kind or [])}"',
                    part.line,
                    cure='If it is a quantity, write "- number"; if it is an object, declare a '
                    'predicate with that as its last argument.',
                )
            continue
        if not isinstance(part, Branch) or not part.head:
            reason = f'"{as_text(part)[:60]}" declares no {what}: write ({what} ?x - type)'
            raise InputError(source, reason, part.line)
        name = part[0]
        assert isinstance(name, Word)
        require_name(name, source)
        if name in RESERVED:
            raise InputError(source, f'"{name}" is a word of PDDL, not a {what}', name.line)
        variables = typed_variables(
            part.like(part[1:]), types, source, f'the {what} "{name}"', part.line
        )
        declared = Declared(name, tuple(variables.items()))
        if name in found and [k for _, k in found[name].parameters] != [*variables.values()]:
            raise unequal(f'the {what} "{name}"', found[name].name, name, source)
        found.setdefault(str(name), declared)
    return found
