"""What all pages share: who may come, headers, static files, and pages that say what is wrong."""

import argparse
import http.client
import logging
import signal
import socket
import subprocess
import sys
from contextlib import ExitStack

import pytest

pytest.importorskip('django', reason='the extra [web] is not installed')

from browser import overflow, person, resized, served, violations  # noqa: E402
from study_client import STUDY  # noqa: E402

from mirror_explainer.web.address import add_address_arguments, address  # noqa: E402
from mirror_explainer.web.refusals import MOST_WARNINGS, PERIOD, FewWarnings  # noqa: E402
from mirror_explainer.web.site import CONTENT_SECURITY_POLICY  # noqa: E402

TOKEN = 'a-token-of-the-test'
PROGRAM = """
import argparse
from mirror_explainer.web.address import add_address_arguments, address
from mirror_explainer.web.serving import serve
from mirror_explainer.web.refusals import MOST_WARNINGS, PERIOD, FewWarnings  # noqa: E402
from mirror_explainer.web.site import Site, configure
parser = argparse.ArgumentParser()
add_address_arguments(parser, 0)
at = address(parser.parse_args())
configure(Site('demo', 'demo_page'), at)
serve(at)
"""


def demo(*arguments, **how):
    return served(['-c', PROGRAM, *arguments], **how)


@pytest.fixture(scope='module')
def site():
    with demo() as server:
        yield server


@pytest.fixture(scope='module')
def guarded():
    with demo('--token', TOKEN) as server:
        yield server


def ask(server, path='/', method='GET', body=None, host='localhost', **headers):
    """Ask over plain HTTP, with no help from any library; follow nothing."""
    connection = http.client.HTTPConnection('127.0.0.1', int(server.port))
    named = {name.replace('_', '-'): value for name, value in headers.items()}
    connection.request(method, path, body, {'Host': f'{host}:{server.port}', **named})
    response = connection.getresponse()
    response.text = response.read().decode()
    connection.close()
    return response


def logged(file):
    """Return the lines of a log, without waitress's own of a busy machine."""
    return [line for line in file.read_text().splitlines() if 'Task queue depth' not in line]


def parsed(*arguments):
    parser = argparse.ArgumentParser()
    add_address_arguments(parser, 8000)
    return address(parser.parse_args(arguments))


# Who may come


def test_by_default_only_this_machine_is_listened_to():
    at = parsed()

    assert (at.host, at.port, at.token) == ('127.0.0.1', 8000, None)
    assert at.url(8000) == 'http://127.0.0.1:8000/'


@pytest.mark.parametrize('host', ['0.0.0.0', '192.0.2.7', '::'])
def test_anything_wider_than_this_machine_gets_a_token(host):
    at = parsed('--host', host)

    assert len(at.token) >= 20
    assert at.token != parsed('--host', host).token
    assert at.url(1).endswith(f':1/?token={at.token}')


def test_a_name_given_is_the_one_in_the_printed_address():
    at = parsed('--host', '0.0.0.0', '--name', 'robot.example', '--token', TOKEN)

    assert at.url(80) == f'http://robot.example:80/?token={TOKEN}'


@pytest.mark.parametrize('host', ['localhost', '127.0.0.1'])
def test_this_machine_is_reached_by_its_own_names(site, host):
    assert ask(site, host=host).status == 200


@pytest.mark.parametrize('path', ['/', '/static/style.css'])
def test_another_name_that_points_here_is_refused_and_the_option_for_it_is_told(site, path):
    response = ask(site, path, host='robot.local')

    assert response.status == 400
    assert 'not known by that name' in response.text
    assert '<code>--name robot.local</code>' in response.text


def test_what_no_machine_can_be_called_is_not_shown_or_logged(tmp_path):
    hosts = ['<b>robot</b>', 'robot_1', "robot' --token known", 'r' * 300, '', '{{ host }}']
    with (tmp_path / 'log').open('w') as log, demo(stderr=log) as server:
        for host in hosts:
            response = ask(server, host=host)
            assert response.status == 400
            assert 'No machine can have the name' in response.text
            assert not host or host not in response.text
    (line,) = logged(tmp_path / 'log')

    assert 'a name that none can have' in line


def test_the_log_has_one_line_for_a_name_and_few_for_many(tmp_path):
    arguments = ['--token', TOKEN, '--name', 'robot.example']
    with (tmp_path / 'log').open('w') as log, demo(*arguments, stderr=log) as server:
        for host in ['robot.local'] * 3 + [f'{number}.example' for number in range(100)]:
            assert ask(server, f'/?token={TOKEN}', host=host).status == 400
        assert ask(server, f'/?token={TOKEN}', host='robot.example').status == 302
    lines = logged(tmp_path / 'log')

    assert sum('which this machine is not known by' in line for line in lines) <= MOST_WARNINGS
    assert lines[0].endswith('start this program with --name robot.local')
    assert sum('robot.local' in line for line in lines) == 1
    assert not any(TOKEN in line for line in lines)


def test_whoever_asks_for_what_is_not_there_cannot_fill_the_log(tmp_path):
    with (tmp_path / 'log').open('w') as log, demo(stderr=log) as server:
        for number in range(100):
            assert ask(server, f'/nowhere-{number}%0Aforged').status == 404
            assert ask(server, method='POST', body='said=hello').status == 403
        assert ask(server, '/broken').status == 500
        assert ask(server, '/broken').status == 500
    text = (tmp_path / 'log').read_text()

    assert 'Not Found: /nowhere-0' in text
    assert text.count('Not Found') < MOST_WARNINGS
    assert text.count('Forbidden') == 1
    assert 'forged' not in text.replace('\\nforged', '').split()
    assert text.count('RuntimeError: broken on purpose') == 2  # an error of ours is never hidden


def test_a_warning_is_told_again_after_a_while():
    now = 0.0
    few = FewWarnings(clock=lambda: now)

    def is_told(message):
        return few.filter(logging.makeLogRecord({'msg': message, 'levelno': logging.WARNING}))

    assert is_told('robot.local')
    assert not is_told('robot.local')
    now = PERIOD + 1
    assert is_told('robot.local')


def test_without_the_token_nothing_is_shown(guarded):
    for path in ('/', '/broken', '/nowhere', '/?token=', '/?token=wrong', '/?token=%C3%A9'):
        response = ask(guarded, path)
        assert response.status == 403, path
        assert 'the full address' in response.text
    assert ask(guarded, method='POST', body='said=hello').status == 403


def test_the_token_is_exchanged_for_a_cookie_that_does_not_hold_it(guarded):
    first = ask(guarded, f'/?token={TOKEN}')
    cookie = first.headers['Set-Cookie']

    assert (first.status, first.headers['Location']) == (302, '/')
    assert TOKEN not in cookie
    assert 'HttpOnly' in cookie
    assert 'SameSite=Lax' in cookie
    assert ask(guarded, Cookie=cookie.split(';')[0]).status == 200
    assert ask(guarded, Cookie='demo_access=guessed').status == 403


def test_the_token_never_sends_a_browser_elsewhere(guarded):
    assert ask(guarded, f'//evil.example/?token={TOKEN}').headers['Location'] == '/evil.example/'


def test_what_else_the_address_asks_for_outlasts_the_token(guarded):
    response = ask(guarded, f'/?token={TOKEN}&follow=on&said=a%26b')

    assert response.headers['Location'] == '/?follow=on&said=a%26b'


def test_a_form_from_elsewhere_is_refused(site):
    page = ask(site)
    cookie = page.headers['Set-Cookie'].split(';')[0]
    token = page.text.split('csrfmiddlewaretoken" value="')[1].split('"')[0]
    sent = {
        'Content_Type': 'application/x-www-form-urlencoded',
        'Cookie': cookie,
    }
    body = f'csrfmiddlewaretoken={token}&said=hello'

    assert ask(site, method='POST', body=body, **sent).text == 'hello'
    through_a_proxy = ask(site, method='POST', body=body, Origin='https://localhost', **sent)
    assert through_a_proxy.text == 'hello'
    elsewhere = ask(site, method='POST', body=body, Origin='http://evil.example', **sent)
    assert elsewhere.status == 403
    assert 'This form has expired' in elsewhere.text
    assert ask(site, method='POST', body='said=hello', **sent).status == 403


@pytest.mark.parametrize(
    ('arguments', 'reason'),
    [
        (['--port', '70000'], '"70000" is no port'),
        (['--token', 'short'], 'a token has 8 or more'),
    ],
)
def test_bad_arguments_end_with_a_sentence(arguments, reason, capsys):
    with pytest.raises(SystemExit):
        parsed(*arguments)

    assert reason in capsys.readouterr().err


# What is sent


@pytest.mark.parametrize('path', ['/', '/static/style.css', '/nowhere', '/broken'])
def test_every_answer_forbids_what_no_page_needs(site, path):
    headers = ask(site, path).headers

    assert headers['Content-Security-Policy'] == CONTENT_SECURITY_POLICY
    assert "default-src 'none'" in CONTENT_SECURITY_POLICY
    assert 'unsafe' not in CONTENT_SECURITY_POLICY
    assert headers['X-Content-Type-Options'] == 'nosniff'
    assert headers['X-Frame-Options'] == 'DENY'
    assert headers['Referrer-Policy'] == 'same-origin'
    assert headers['Cache-Control'] in ('no-store', 'max-age=0, public')
    assert 'Server' not in headers


def test_static_files_are_a_fixed_list(site):
    for name, kind in (
        ('style.css', 'text/css'),
        ('django_htmx/htmx-2.min.js', 'text/javascript'),
        ('icon.svg', 'image/svg+xml'),
    ):
        response = ask(site, f'/static/{name}')
        assert response.status == 200
        assert response.headers['Content-Type'].split(';')[0] == kind
        again = ask(site, f'/static/{name}', If_None_Match=response.headers['ETag'])
        assert again.status == 304
    for path in (
        '/static/',
        '/static/../site.py',
        '/static/%2e%2e/site.py',
        '/static/..%2fsite.py',
        '/static//etc/passwd',
        '/static/style.css%00',
        '/../../etc/passwd',
    ):
        assert ask(site, path).status == 404, path


def test_a_mistake_of_ours_shows_no_insides(site):
    response = ask(site, '/broken')

    assert response.status == 500
    assert 'has made a mistake' in response.text
    assert 'on purpose' not in response.text


def test_a_body_larger_than_any_form_is_refused(site):
    kind = 'application/x-www-form-urlencoded'
    assert ask(site, method='POST', body='a=' + 'x' * 100_000, Content_Type=kind).status == 413


def test_a_page_that_only_takes_forms_says_so_and_head_is_answered(site):
    response = ask(site, '/takes_forms')

    assert (response.status, response.headers['Allow']) == (405, 'POST')
    assert 'takes what a form sends' in response.text
    assert ask(site, method='HEAD').status == 200
    assert ask(site, '/static/style.css', method='HEAD').status == 200


def test_an_address_that_is_taken_is_told_with_the_cure(site, tmp_path):
    pytest.importorskip('pandas', reason='the extra [experiments] is not installed')
    ended = subprocess.run(
        [sys.executable, *STUDY, 'serve', '--port', site.port, '--database', tmp_path / 'study'],
        capture_output=True,
        text=True,
    )

    assert ended.returncode == 2
    assert f'127.0.0.1:{site.port}: another program serves at this address' in ended.stderr
    assert 'End it, or name another with --port' in ended.stderr


def test_a_crowd_of_idle_connections_locks_nobody_out():
    with demo() as server, ExitStack() as crowd:
        for _ in range(400):
            idle = socket.create_connection(('127.0.0.1', int(server.port)))
            crowd.enter_context(idle)
            idle.sendall(b'HEAD / HTTP/1.1\r\nHost: localhost\r\n\r\n')

        assert ask(server).status == 200


@pytest.mark.parametrize('told', [signal.SIGINT, signal.SIGTERM])
def test_a_server_ends_when_it_is_told_to(told):
    with demo() as server:
        server.process.send_signal(told)

        assert server.process.wait() == 0


# In a browser


def test_a_page_updates_itself_within_the_policy(site, chromium):
    from playwright.sync_api import expect  # where there is chromium, there is playwright

    with person(chromium) as page:
        page.goto(site.url)
        page.get_by_label('Say').fill('<b>hello</b>')
        page.keyboard.press('Enter')
        expect(page.locator('#said')).to_have_text('hello')


def test_pages_that_say_what_is_wrong_can_be_read_by_everyone(site, chromium):
    with person(chromium) as page:
        addresses = [f'{site.url}{path}' for path in ('', 'nowhere', 'broken')]
        # Which chromium takes for this machine, and the site does not know.
        for address in (*addresses, f'http://robot.localhost:{site.port}'):
            page.goto(address)
            for _ in resized(page):
                assert overflow(page) <= 0
                assert violations(page) == []
        page.errors.clear()  # chromium reports what was refused, as was asked for
