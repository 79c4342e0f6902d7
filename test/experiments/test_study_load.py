"""Two hundred people in the study at once, by a script, each on a connection that stays open."""

import http.client
import re
import sqlite3
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack
from urllib.parse import urlencode

import pytest

pytest.importorskip('django', reason='the extra [web] is not installed')
pytest.importorskip('pandas', reason='the extra [experiments] is not installed')

from browser import served  # noqa: E402
from study_client import STUDY  # noqa: E402

PEOPLE, STEPS, AT_ONCE = 200, 1, 32


class Visitor:
    """A browser's part on one connection, which is kept alive."""

    def __init__(self, port):
        self.connection = http.client.HTTPConnection('127.0.0.1', port, timeout=120)
        self.cookies, self.html = {}, ''

    def ask(self, path, **form):
        if form:
            token = re.search('csrfmiddlewaretoken" value="(.*?)"', self.html)[1]
            body, method = urlencode({'csrfmiddlewaretoken': token, **form}), 'POST'
        else:
            body, method = None, 'GET'
        headers = {
            'Host': 'localhost',
            'Cookie': '; '.join(f'{name}={value}' for name, value in self.cookies.items()),
            'Content-Type': 'application/x-www-form-urlencoded',
        }
        try:
            self.connection.request(method, path, body, headers)
        except ConnectionError:  # the server ends what was idle for two minutes, of slow crowds
            self.connection.close()
            self.connection.request(method, path, body, headers)
        response = self.connection.getresponse()
        self.html = response.read().decode()
        for header in response.headers.get_all('Set-Cookie', []):
            name, _, value = header.split(';')[0].partition('=')
            self.cookies[name] = value
        if response.status == 302:
            return self.ask(response.headers['Location'])
        assert response.status == 200, (path, response.status, self.html[:200])
        return self.html

    def field(self, name):
        return re.search(f'name="{name}" value="(.*?)"', self.html)[1]

    def begin(self):
        self.ask('/')
        self.ask('/join', consent='on', new=self.field('new'))
        self.ask('/start', begin='1')

    def answer(self):
        step = int(self.field('step'))
        self.ask('/answer', scenario=self.field('scenario'), step=step, choice='?')
        assert int(self.field('step')) == step + 1


def test_two_hundred_people_at_once_each_go_their_way_and_nobody_is_locked_out(tmp_path):
    file = tmp_path / 'study.sqlite3'
    command = [*STUDY, 'serve', '--database', str(file), '--port', '0', '--scenarios', '3']
    with served(command) as server, ExitStack() as stack:
        people = [Visitor(int(server.port)) for _ in range(PEOPLE)]
        for one in people:
            stack.callback(one.connection.close)
        with ThreadPoolExecutor(AT_ONCE) as pool:
            list(pool.map(Visitor.begin, people))
            for _ in range(STEPS):
                list(pool.map(Visitor.answer, people))
        newcomer = Visitor(int(server.port))
        newcomer.begin()
        newcomer.connection.close()

        with sqlite3.connect(file) as kept:
            query = 'SELECT COUNT(DISTINCT number), MAX(number) FROM web_study_participant'
            assert kept.execute(query).fetchone() == (PEOPLE + 1, PEOPLE)
            query = 'SELECT COUNT(*) FROM web_study_step WHERE answer IS NOT NULL'
            assert kept.execute(query).fetchone() == (PEOPLE * STEPS,)
