"""People who take part in the study over HTTP, by a script, without a browser."""

import re
import sqlite3
from contextlib import closing
from dataclasses import dataclass
from html import unescape
from http.cookiejar import CookieJar
from random import Random
from urllib.error import HTTPError
from urllib.parse import urlencode
from urllib.request import HTTPCookieProcessor, build_opener

CHOICES = '012?'
RIGHT = {'check-0': '1', 'check-1': '0'}  # the answers to the questions after the practice
STUDY = ['-m', 'mirror_explainer.experiments.study.user_study']


@dataclass(frozen=True)
class Page:
    """What a page shows, as far as scripts need it."""

    status: int
    html: str

    @property
    def title(self):
        """The page's name."""
        return unescape(re.search('<title>(.*?)</title>', self.html)[1])

    @property
    def scenario(self):
        """Of a step: the scenario's name."""
        return re.search('name="scenario" value="(.*?)"', self.html)[1]

    @property
    def step(self):
        """Of a step: its number."""
        return int(re.search('name="step" value="(.*?)"', self.html)[1])

    @property
    def said(self):
        """Of a step: the sentences."""
        listed = self.html.split('<ol>')[1].split('</ol>')[0]
        return [unescape(text).strip() for text in re.findall('<li[^>]*>([^<]*)', listed)]

    @property
    def goals(self):
        """Of a step: the goals to choose from, by their names in the tables."""
        words = [unescape(text) for text in re.findall('class="goal">(.*?)<', self.html)]
        return [goal_name(text) for text in words if goal_name(text)]


def goal_name(words):
    """Return the name of a goal that is told in words, None for "I don't know yet"."""
    return words[0].lower() + words[1:] if ' and ' in words else None


def copy_database(file, to):
    """Copy a study's database as it is now, also while it is served."""
    with closing(sqlite3.connect(file)) as now, closing(sqlite3.connect(to)) as copy:
        now.backup(copy)


class Person:
    """A browser's part: cookies, forms, redirects."""

    def __init__(self, url):
        self.url = url
        self.cookies = CookieJar()
        self._opener = build_opener(HTTPCookieProcessor(self.cookies))
        self.page = self.get('')

    def get(self, path):
        """Open a page."""
        self.page = self._ask(path)
        return self.page

    def bytes(self, path):
        """Download something."""
        with self._opener.open(self.url + path, timeout=60) as response:
            return response.read()

    def post(self, path, **fields):
        """Send a form of the page that is open."""
        token = re.search('csrfmiddlewaretoken" value="(.*?)"', self.page.html)[1]
        self.page = self._ask(path, urlencode({'csrfmiddlewaretoken': token, **fields}).encode())
        return self.page

    def answer(self, choice, **fields):
        """Answer the step that is open."""
        page = self.page
        return self.post(
            'answer', **{'scenario': page.scenario, 'step': page.step, 'choice': choice, **fields}
        )

    def join(self):
        """Agree, and begin."""
        new = re.search('name="new" value="(.*?)"', self.page.html)[1]
        return self.post('join', consent='on', new=new)

    @property
    def code(self):
        """What one comes back with."""
        return next(c.value for c in self.cookies if c.name == 'study_participant')

    def take_part(self, seed):
        """Answer everything at random; return the choices by scenario and step, and the name."""
        self.join()
        given = self.answer_the_rest(Random(seed))
        if 'action="/close"' in self.page.html:
            self.post('close')
        return given, re.search('under the name (p-[a-z0-9]+)', self.page.html)[1]

    def answer_the_rest(self, random):
        """Answer at random until there is no more; return the choices by scenario and step."""
        given = {}
        while True:
            if 'action="/start"' in self.page.html:
                self.post('start')
            elif 'action="/check"' in self.page.html:
                self.post('check', **RIGHT)
            elif 'action="/answer"' in self.page.html:
                page, choice = self.page, random.choice(CHOICES)
                given[page.scenario, page.step] = (page, choice)
                self.answer(choice)
            else:
                return given

    def _ask(self, path, data=None):
        try:
            with self._opener.open(self.url + path, data, timeout=60) as response:
                return Page(response.status, response.read().decode())
        except HTTPError as error:
            return Page(error.code, error.read().decode())
