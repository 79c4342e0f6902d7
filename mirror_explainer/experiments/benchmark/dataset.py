"""The PUCRS data set of goal recognition problems, as archives or as unpacked folders.

Pereira and Meneguzzi, doi 10.5281/zenodo.825877. An instance is domain.pddl,
template.pddl (a problem with <HYPOTHESIS> in place of its goal), hyps.dat,
real_hyp.dat and, in the original archives, obs.dat.
"""

import json
import re
import tarfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from mirror_explainer.errors import InputError
from mirror_explainer.text_files import read_text

_REQUIRED = ('domain.pddl', 'template.pddl', 'hyps.dat', 'real_hyp.dat')
_FILES = (*_REQUIRED, 'obs.dat')
_ARCHIVE = '.tar.bz2'
_LARGEST_FILE = 8_000_000  # bytes; the data set's largest is some 100 kB
# "block-words_p01_hyp-0_full" has all observations, "block-words_p01_hyp-0_10_1" 10 % of them.
_OBSERVABILITY = re.compile(r'(?<=\d)_(?:(?P<full>full|100)|10|30|50|70)(?:_\d+)?$')
_HYPOTHESIS = re.compile('<hypothesis>', re.IGNORECASE)


@dataclass(frozen=True)
class Location:
    """Where an instance is: an archive or a folder; `full` says whether all is observed."""

    domain: str
    name: str
    path: Path
    full: bool


@dataclass(frozen=True)
class Listed:
    """An instance as manifest.json lists it, which our copy of the data set has.

    `hard` are those that optimal planning cannot finish; `observed` is the length
    of the recorded plan, None where it is not known.
    """

    domain: str
    name: str
    hard: bool
    observed: int | None


@dataclass(frozen=True)
class RecognitionProblem:
    """One instance: a planning problem without its goal, and the pool of goals.

    `goals` are distinct PDDL goals in the order of hyps.dat, `true_goal` is
    the one of real_hyp.dat. `observed` is the length of the recorded plan,
    where the data set has it in full.
    """

    domain: str
    template: str
    goals: tuple[str, ...]
    true_goal: str
    observed: int | None

    def problem(self, goal: str) -> str:
        """Return the PDDL problem with this goal."""
        atoms = goal.removeprefix('(and ').removesuffix(')')
        return _HYPOTHESIS.sub(lambda _: atoms, self.template)


def find_instances(dataset: Path) -> dict[str, list[Location]]:
    """Return the data set's domains with their instances, both in the order of their names.

    A domain is named by its folder; folders such as "100", which sort by
    observability, are passed over. Of one problem with several observations the
    full ones are taken. Raises InputError if there is no instance.
    """
    if not dataset.is_dir():
        raise InputError(str(dataset), 'there is no such folder; the PUCRS data set is expected')
    chosen: dict[tuple[str, str], Location] = {}
    for location in sorted(_locations(dataset), key=lambda found: (not found.full, found.path)):
        chosen.setdefault((location.domain, location.name), location)
    if not chosen:
        raise InputError(
            str(dataset),
            f'this is no data set: neither *{_ARCHIVE} archives nor folders with template.pddl '
            'are in it',
        )
    domains: dict[str, list[Location]] = {}
    for (domain, _), location in sorted(chosen.items()):
        domains.setdefault(domain, []).append(location)
    return domains


def read_instance(location: Location, dataset: Path) -> RecognitionProblem:
    """Read one instance; raises InputError that names what is missing or broken."""
    source = str(location.path)
    texts = _archived(location.path) if location.path.is_file() else _unpacked(location.path)
    missing = [name for name in _REQUIRED if name not in texts]
    if missing:
        raise InputError(source, f'the instance lacks {", ".join(missing)}')
    if not _HYPOTHESIS.search(texts['template.pddl']):
        raise InputError(source, 'template.pddl has no <HYPOTHESIS> in place of the goal')
    pool = dict.fromkeys(_goal(line) for line in texts['hyps.dat'].splitlines() if line.strip())
    if not texts['real_hyp.dat'].strip():
        raise InputError(source, 'real_hyp.dat is empty')
    observed = _listed_length(dataset, location)
    if location.full and 'obs.dat' in texts:
        observed = sum(1 for line in texts['obs.dat'].splitlines() if line.strip())
    return RecognitionProblem(
        domain=texts['domain.pddl'],
        template=texts['template.pddl'],
        goals=tuple(pool),
        true_goal=_goal(texts['real_hyp.dat'].strip().splitlines()[0]),
        observed=observed,
    )


def manifest(dataset: Path) -> list[Listed]:
    """Return what the data set's manifest.json lists, in its order.

    Raises InputError if there is none, or if it is something else.
    """
    file = str(dataset / 'manifest.json')
    text = read_text(file)
    try:
        return [
            Listed(
                entry['domain'],
                entry['instance'],
                hard=entry.get('lmcut_tier') == 'hard',
                observed=entry.get('obs100_len'),
            )
            for entry in json.loads(text)['instances']
        ]
    except (ValueError, KeyError, TypeError, AttributeError) as error:
        raise InputError(file, 'it does not list "instances" by "domain"') from error


def listed_locations(dataset: Path, *, hard: bool) -> list[Location]:
    """Return where the hard instances of the manifest are, or the others, in its order.

    Raises InputError if there is no manifest, or one of them is not there.
    """
    found = {
        (location.domain, location.name): location
        for locations in find_instances(dataset).values()
        for location in locations
    }
    listed = [(entry.domain, entry.name) for entry in manifest(dataset) if entry.hard is hard]
    missing = ', '.join('/'.join(place) for place in listed if place not in found)
    if missing:
        raise InputError(str(dataset), f'the manifest lists what is not there: {missing}')
    return [found[place] for place in listed]


def _locations(dataset: Path) -> Iterator[Location]:
    archives = [(path, path.name.removesuffix(_ARCHIVE)) for path in dataset.rglob(f'*{_ARCHIVE}')]
    folders = [(path.parent, path.parent.name) for path in dataset.rglob('template.pddl')]
    for path, stem in [*archives, *folders]:
        parents = [dataset.name, *path.parent.relative_to(dataset).parts]
        domain = next((name for name in reversed(parents) if not name.isdecimal()), dataset.name)
        observability = _OBSERVABILITY.search(stem)
        full = bool(observability['full']) if observability else parents[-1] in ('100', domain)
        yield Location(domain, _OBSERVABILITY.sub('', stem), path, full)


def _archived(path: Path) -> dict[str, str]:
    """Read the instance's files from an archive, without writing any to the disk."""
    texts: dict[str, str] = {}
    try:
        with tarfile.open(path, 'r|bz2') as archive:
            for member in archive:
                name = Path(member.name).name
                if not member.isfile() or name not in _FILES:
                    continue
                if member.size > _LARGEST_FILE:
                    raise InputError(str(path), f'{name} is too large for an instance')
                content = archive.extractfile(member)
                assert content is not None  # only for what is no file
                texts[name] = content.read().decode('utf-8', errors='replace').lower()
    except (tarfile.TarError, OSError, EOFError) as error:
        raise InputError(str(path), f'the archive is broken: {error}') from error
    return texts


def _unpacked(folder: Path) -> dict[str, str]:
    try:
        return {
            name: (folder / name).read_text('utf-8', errors='replace').lower()
            for name in _FILES
            if (folder / name).is_file()
        }
    except OSError as error:
        raise InputError(str(folder), f'it cannot be read: {error.strerror}') from error


def _goal(line: str) -> str:
    """Return "(p a), (q b)" as a PDDL goal, its atoms sorted: equal goals are equal texts."""
    atoms = sorted({' '.join(atom.split()) for atom in line.lower().split(',') if atom.strip()})
    return f'(and {" ".join(atoms)})'


def _listed_length(dataset: Path, location: Location) -> int | None:
    """Return the recorded plan's length from the manifest, if there is one that has it."""
    try:
        listed = manifest(dataset)
    except InputError:
        return None
    lengths = {(entry.domain, entry.name): entry.observed for entry in listed}
    length = lengths.get((location.domain, location.name))
    return length if isinstance(length, int) else None
