"""Where everything is drawn of a scenario, and the same in words: from its PDDL, as it is now.

The warehouse's places have their place on the picture; those of another map lie on a ring.
"""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

from mirror_explainer.experiments.study.web_study.texts import Words
from mirror_explainer.pddl import Task, words_of

WIDTH, HEIGHT = 720, 530
_INSET = 9  # of a room, so that the names of what lies in it do not touch its walls


@dataclass(frozen=True)
class Point:
    """A point of the picture, in its units, from the top left."""

    x: float
    y: float


@dataclass(frozen=True)
class Labelled(Point):
    """Something that is drawn at a point, with what it is called."""

    label: str


@dataclass(frozen=True)
class Door(Labelled):
    """A door; its label stands beside it, towards the middle."""

    @property
    def label_x(self) -> float:
        """Where the label begins or ends."""
        return self.x + (22 if self.at_left else -22)

    @property
    def at_left(self) -> bool:
        """Whether the door is in the left half."""
        return self.x < WIDTH / 2


@dataclass(frozen=True)
class Place(Labelled):
    """A place: the middle of its box, and the size of that."""

    width: float
    height: float
    room: bool

    @property
    def left(self) -> float:
        """Where the box begins."""
        return self.x - self.width / 2

    @property
    def top(self) -> float:
        """Where the box begins."""
        return self.y - self.height / 2

    @property
    def label_y(self) -> float:
        """The base line of the label: above what lies in a room, below in a corridor."""
        return self.top + 24 if self.room else self.top + self.height - 10


@dataclass(frozen=True)
class Item(Labelled):
    """An object: shape and colour are the words of its name, "" where it has no such."""

    shape: str
    colour: str

    @property
    def lines(self) -> list[str]:
        """The label, a word a line."""
        return self.label.split()


@dataclass(frozen=True)
class Way:
    """A way between two points."""

    start: Point
    end: Point


@dataclass(frozen=True)
class Drawing:
    """All that is drawn, and `words`: the same as sentences."""

    places: tuple[Place, ...]
    ways: tuple[Way, ...]
    doors: tuple[Door, ...]
    items: tuple[Item, ...]
    station: Labelled | None
    robot: Point | None
    charged: bool
    words: tuple[str, ...]
    width: int = WIDTH
    height: int = HEIGHT


_CORRIDOR = (212.0, 84.0)  # a telephone's large letters fit in
_ROOM = (236.0, 160.0)
_KNOWN: Mapping[str, Place] = {
    'left': Place(111, 100, '', *_CORRIDOR, False),
    'center': Place(347, 100, '', *_CORRIDOR, False),
    'right': Place(603, 100, '', *_CORRIDOR, False),
    'doors': Place(255, 250, '', 252, 56, False),
    'red_room': Place(124, 430, '', *_ROOM, True),
    'blue_room': Place(366, 430, '', *_ROOM, True),
}
_DOORS: Mapping[str, Point] = {
    'top_left_door': Point(40, 26),
    'top_right_door': Point(680, 26),
    'bottom_door': Point(674, 500),
}
_SHAPES = ('circle', 'square', 'triangle')
_COLOURS = ('red', 'blue')


def drawing(task: Task, words: Words) -> Drawing:
    """Return the picture of the task's initial state, without its goal, labelled in a language."""
    facts: dict[str, list[list[str]]] = {}
    for fact in sorted(task.initial_facts):
        predicate, *arguments = words_of(fact)
        facts.setdefault(predicate, []).append(arguments)
    lying = {item: room for item, room in facts.get('item-at', [])}
    names = [item.name for item in task.model.objects(task.model.user_type('place'))]
    places = _places(names, set(lying.values()), words)
    doors = {door: _door(door, places[place], words) for door, place in facts.get('door-at', [])}
    ways = [
        *(Way(places[a], places[b]) for a, b in _pairs(facts.get('connected', []))),
        *(Way(places[place], doors[door]) for door, place in facts.get('door-at', [])),
    ]
    station = next((places[place] for [place] in facts.get('station-at', [])), None)
    robot = next((places[place] for [place] in facts.get('robot-at', [])), None)
    return Drawing(
        places=tuple(places.values()),
        ways=tuple(ways),
        doors=tuple(doors.values()),
        items=tuple(_items(places, lying, words)),
        station=Labelled(station.x + 42, station.y - 12, words.text('station'))
        if station
        else None,
        robot=Point(robot.x - 38, robot.y - 6) if robot else None,
        charged='charged' in facts,
        words=tuple(_sentences(places, facts, words)),
    )


def _places(names: Sequence[str], rooms: set[str], words: Words) -> dict[str, Place]:
    """Return where each place lies: on the warehouse's map, or else all on a ring."""
    if set(names) <= set(_KNOWN):
        return {name: replace(_KNOWN[name], label=words.thing(name)) for name in names}
    found = {}
    for index, name in enumerate(names):
        turn = 2 * math.pi * index / len(names)
        x = WIDTH / 2 + (WIDTH / 2 - 140) * math.sin(turn)
        y = HEIGHT / 2 - (HEIGHT / 2 - 80) * math.cos(turn)
        found[name] = Place(
            x, y, words.thing(name), *(_ROOM if name in rooms else _CORRIDOR), name in rooms
        )
    return found


def _door(name: str, place: Place, words: Words) -> Door:
    """Return where a door is: in the corner that its name says, or else above its place."""
    point = _DOORS.get(name, Point(place.x, max(20, place.y - place.height)))
    return Door(point.x, point.y, words.thing(name))


def _items(places: Mapping[str, Place], lying: Mapping[str, str], words: Words) -> Iterator[Item]:
    """Yield the items of each room, side by side."""
    for room in dict.fromkeys(lying.values()):
        inside = [item for item, where in lying.items() if where == room]
        place = places[room]
        for index, item in enumerate(inside):
            x = place.left + _INSET + (place.width - 2 * _INSET) * (index + 0.5) / len(inside)
            yield Item(x, place.y - 4, words.thing(item), *look(item))


def look(item: str) -> tuple[str, str]:
    """Return an item's shape and colour, which its name says; "" where it does not."""
    parts = item.split('_')
    return (
        next((shape for shape in _SHAPES if shape in parts), ''),
        next((colour for colour in _COLOURS if colour in parts), ''),
    )


def _sentences(
    places: Mapping[str, Place], facts: Mapping[str, list[list[str]]], words: Words
) -> Iterator[str]:
    """Yield what the picture shows, a sentence each."""
    for [place] in facts.get('robot-at', []):
        yield words.text('robot_in', place=places[place].label)
    yield words.text('battery_charged' if 'charged' in facts else 'battery_empty')
    for [place] in facts.get('station-at', []):
        yield words.text('station_in', place=places[place].label)
    lying = facts.get('item-at', [])
    for room in dict.fromkeys(room for _, room in lying):
        inside = [
            words.text('an_item', item=words.thing(item)) for item, where in lying if where == room
        ]
        *first, last = inside
        listed = f'{", ".join(first)} {words.text("and")} {last}' if first else last
        yield words.text('items_in', place=places[room].label, items=listed)
    for door, place in facts.get('door-at', []):
        yield words.text('door_from', door=words.thing(door), place=places[place].label)
    for a, b in _pairs(facts.get('connected', [])):
        yield words.text('way_between', one=places[a].label, other=places[b].label)


def _pairs(connected: Sequence[Sequence[str]]) -> list[tuple[str, str]]:
    """Return each two places that are joined, once."""
    return list(dict.fromkeys((min(pair), max(pair)) for pair in connected))
