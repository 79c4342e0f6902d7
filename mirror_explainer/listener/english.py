"""English verbs: which words are verbs, and "I will grab it." while it is done and afterwards.

lemminflect, which knows the verbs and inflects them, is loaded when it is first needed.
"""

import re
from functools import cache
from itertools import dropwhile


def word_set(words: str) -> frozenset[str]:
    """Return the words of a text with spaces between them."""
    return frozenset(words.split())


_FUTURE = re.compile(r"\s*(I will|I'll)\s+", re.IGNORECASE)
_SUBJECT = re.compile(r"\bI(?: (?:will|am|have|did|was|meant|cannot)|'(?:ll|m|ve))\b")
_ARTICLE_LAST = re.compile(r'\b(the|an?)\s+$')
_ARTICLE_FIRST = re.compile(
    r'(?:the|an?|my|your|his|her|our|their)\s(?!(?:and|or)\b)', re.IGNORECASE
)
_TO_LAST = re.compile(r'\sto\s+$')
_WHERETO = re.compile(r'(?:home|upstairs|downstairs|outside|here|there)(?=$|,| and )')
_AN = re.compile(r'(?!eu|one?\b|once|uni|us[aeu]|uti)[aeiou]|hour|honest|heir', re.IGNORECASE)
_SUBJECTS = {'i will': ('I am', 'I have'), "i'll": ("I'm", "I've")}
_ADVERBS = word_set('then now first next also again soon just still both finally')
# What stands after a verb, and hardly after a noun that "and" adds to another.
_AFTER_VERBS = word_set(
    'the a an it its them this that these those my your his her their our you me him us some '
    'any each every all up down off out back away over'
)
# Nouns as well, but hardly without an article after "and": "turn left and go on".
_HARDLY_NOUNS = word_set(
    'check clean close come do drive fly get go leave look make move open press put return start '
    'stop turn wait walk wash'
)
# Words that have a capital only where all words of a name have one.
_IN_TITLES = word_set('a an and at by for from in into of off on onto or out the to up with')
# Where the library's word is rarer, or of another meaning.
_PRESENT = {'glue': 'gluing', 'program': 'programming', 'tie': 'tying'}
_PAST = {
    'blend': 'blended', 'get': 'got', 'lean': 'leaned', 'lie': 'lain', 'light': 'lit',
    'program': 'programmed', 'shrink': 'shrunk', 'spit': 'spat', 'strike': 'struck',
    'wake': 'woken',
}  # fmt: skip
# Verbs as well, but hardly as the first word of a name: "STATE_RETURN", "tool-change".
_FIRST_NOUNS = word_set('floor full object person room self state station task tool')
# So end verbs, also those that the library does not know: "palletize".
_VERB_ENDING = re.compile(r'(?:ate|i[sz]e|ify)$')
_PREFIXES = re.compile(r'(?:un|re|de|dis|pre|over|co|tele)-?(?=\w{4})')


def is_verb(word: str) -> bool:
    """Say whether an English verb has this base form: "grab", "undock"; not "grabs"."""
    return any('VERB' in _inflections(form) for form in (word, _PREFIXES.sub('', word, count=1)))


def is_known(word: str) -> bool:
    """Say whether this is the base form of an English word of any kind."""
    return bool(_inflections(word))


def is_first_noun(word: str) -> bool:
    """Say whether a verb is hardly one as the first word of a name: "tool-change"."""
    return word in _FIRST_NOUNS


def is_participle(word: str) -> bool:
    """Say whether this is a verb's regular past form and nothing else: "cooled", not "red"."""
    if not word.endswith('ed') or is_known(word):
        return False
    from lemminflect import getAllLemmas

    return bool(getAllLemmas(word).get('VERB'))


def infinitive(gerund: str) -> str:
    """Return "gather" for "gathering", '' for what is no verb with "-ing"."""
    if not gerund.endswith('ing'):
        return ''
    from lemminflect import getAllLemmas

    lemmas = [lemma for lemma in getAllLemmas(gerund).get('VERB', ()) if lemma != gerund]
    return lemmas[0] if lemmas else ''


def has_subject(sentence: str) -> bool:
    """Say whether this is an English sentence in which I do something."""
    return bool(_SUBJECT.search(sentence))


def has_no_article(name: str) -> bool:
    """Say whether a name wants no "the": "the cup", "my desk", "home"."""
    return bool(_ARTICLE_FIRST.match(name) or _WHERETO.match(name))


def before_name(text: str, name: str) -> str:
    """Return English text before a name with the article that it wants: "an" before "egg".

    A name with an article, "the cup", takes the place of one before it, and "home" of "to".
    """
    if _WHERETO.match(name):
        return _TO_LAST.sub(' ', text)
    found = _ARTICLE_LAST.search(text)
    if not found:
        return text
    if _ARTICLE_FIRST.match(name):
        return text[: found.start()]
    return text if found[1] == 'the' else f'{text[: found.start()]}{indefinite(name)} '


def indefinite(name: str) -> str:
    """Return "a" or "an", as a name wants it."""
    return 'an' if _AN.match(name) else 'a'


@cache
def present_participle(verb: str) -> str:
    """Return "grabbing" for "grab"."""
    return _PRESENT.get(verb) or _inflected(verb, 'VBG')


@cache
def past_participle(verb: str) -> str:
    """Return "grabbed" for "grab", "taken" for "take"."""
    return _PAST.get(verb) or _inflected(verb, 'VBN')


@cache
def other_tenses(future: str) -> tuple[str, str] | None:
    """Return "I am grabbing {i}." and "I have grabbed {i}." for "I will grab {i}.".

    None where the sentence does not begin with "I will" and a verb, or where it cannot be
    told whether a word after an "and" is another verb ("I will take the cup and plate.").
    """
    begin = _FUTURE.match(future)
    if not begin:
        return None
    words = future[begin.end() :].split()
    verbs = _verbs_of(words)
    if not verbs:
        return None
    subjects = _subjects(begin)
    if _bare(words[verbs[0]]) == 'be':
        present, past = words[: verbs[0]] + words[verbs[0] + 1 :], [*words]
        past[verbs[0]] = 'been'
    else:
        present, past = [*words], [*words]
        for place in verbs:
            verb = _bare(words[place])
            present[place] = words[place].replace(verb, present_participle(verb), 1)
            past[place] = words[place].replace(verb, past_participle(verb), 1)
    return ' '.join([subjects[0], *present]), ' '.join([subjects[1], *past])


def verb_parameter(future: str) -> str:
    """Return the parameter that stands where the verb would: "task" for "I will {task}.".

    '' where the sentence does not begin with "I will", or has a word there.
    """
    begin = _FUTURE.match(future)
    words = future[begin.end() :].split() if begin else []
    first = next((word for word in words if not _is_adverb(word)), '')
    found = re.fullmatch(r'\{(\w+)\}[.,;:!]?', first)
    return found[1] if found else ''


def as_verb_phrase(name: str) -> str:
    """Return a task's name as it stands after "I will": "drive to dock 3" for "Drive To Dock 3".

    Also "charge the battery" for "Charging the battery".
    """
    first, *rest = (name.lower() if name.isupper() else name).split(' ')
    if rest and all(word.istitle() for word in rest if word[0].isalpha()):
        lower = [word.lower() for word in rest]  # a title, or names: "Visit Berlin"
        is_title = not _IN_TITLES.isdisjoint(lower)
        rest = [
            low if is_title or is_known(low) else word
            for word, low in zip(rest, lower, strict=True)
        ]
    first = first[0].lower() + first[1:] if first.istitle() else first
    return ' '.join([infinitive(first) or first, *rest])


def begins_with_verb(phrase: str) -> bool:
    """Say whether "boil water" begins with an English verb, perhaps after an adverb."""
    first = _bare(next((word for word in phrase.split() if not _is_adverb(word)), ''))
    return first not in _FIRST_NOUNS and (is_verb(first) or bool(_VERB_ENDING.search(first)))


def phrase_tenses(future: str, phrase: str) -> tuple[tuple[str, str], tuple[str, str]] | None:
    """Return ("I am {task}.", "boiling water") and ("I have {task}.", "boiled water").

    These are for "I will {task}." with the phrase "boil water"; None where its verbs are not
    sure, or the sentence does not begin with "I will".
    """
    begin, made = _FUTURE.match(future), other_tenses(f'I will {phrase}')
    if not begin or not made:
        return None
    present, past = (f'{subject} {future[begin.end() :]}' for subject in _subjects(begin))
    return (present, made[0].removeprefix('I am ')), (past, made[1].removeprefix('I have '))


def inability(future: str) -> str | None:
    """Return "I cannot grab it." for "I will grab it.", None for other sentences."""
    return _begun(future, 'I cannot')


def intention(future: str) -> str | None:
    """Return "I meant to grab it." for "I will grab it.", None for other sentences."""
    return _begun(future, 'I meant to')


def omission(future: str) -> str | None:
    """Return "I did not grab it." for "I will grab it.", None for other sentences."""
    begin = _FUTURE.match(future)
    words = future[begin.end() :].split() if begin else []
    words = [*dropwhile(_is_adverb, words)]
    if not words or _bare(words[0]) in ('not', 'never'):
        return None
    return ' '.join(['I was not', *words[1:]] if words[0] == 'be' else ['I did not', *words])


def _begun(future: str, subject: str) -> str | None:
    begin = _FUTURE.match(future)
    return f'{subject} {future[begin.end() :]}' if begin else None


def _subjects(begin: re.Match[str]) -> tuple[str, str]:
    """Return "I am" and "I have" for "I will" as it is written."""
    return _SUBJECTS[' '.join(begin[1].lower().split())]


def _verbs_of(words: list[str]) -> list[int]:
    """Return the places of the verbs in what follows "I will"; none where that is not sure."""
    first = 0
    while first < len(words) and _is_adverb(words[first]):
        first += 1
    if first == len(words) or not re.fullmatch(r'[a-z][a-z-]*[.,;:!]?', words[first]):
        return []
    if _bare(words[first]) in ('not', 'never'):
        return []
    verbs = [first]
    for place in range(first + 1, len(words)):
        word, before = _bare(words[place]), place - 1
        while before > first and _is_adverb(words[before]):
            before -= 1
        joined = words[before] in ('and', 'or') or words[place - 1] == 'then'
        listed = words[before].endswith(',')
        if not (joined or listed) or _is_adverb(words[place]) or not is_verb(word):
            continue
        following = words[place + 1] if place + 1 < len(words) else ''
        has_object = following.startswith('{') or following in _AFTER_VERBS
        follows_verb = len(verbs) > 1 or before - 1 in verbs
        is_nothing_else = joined and (
            word in _HARDLY_NOUNS or not _inflections(word).keys() - {'VERB'}
        )
        if (words[place] == word and has_object) or (joined and follows_verb) or is_nothing_else:
            verbs.append(place)
        elif joined:
            return []
    return verbs


def _is_adverb(word: str) -> bool:
    bare = _bare(word)
    return bare in _ADVERBS or (bare.endswith('ly') and not is_verb(bare))


def _bare(word: str) -> str:
    return word.rstrip('.,;:!')


@cache
def _inflections(word: str) -> dict[str, tuple[str, ...]]:
    """Return the forms of a known word by kind, "VERB" and "NOUN" among them."""
    from lemminflect import getAllInflections

    kinds: dict[str, tuple[str, ...]] = {}
    for tag, forms in getAllInflections(word).items():
        kind = {'V': 'VERB', 'N': 'NOUN', 'J': 'ADJ', 'R': 'ADV'}.get(tag[0], tag)
        kinds[kind] = (*kinds.get(kind, ()), *forms)
    return kinds


def _inflected(verb: str, tag: str) -> str:
    from lemminflect import getInflection

    forms = [f for f in getInflection(verb, tag, inflect_oov=True) if ('-' in f) == ('-' in verb)]
    return max(forms, key=len) if forms else verb
