"""The study in a real browser: by keyboard alone, through a kill, two at once, for all."""

import sqlite3
import subprocess
import sys
from random import Random

import pytest

pytest.importorskip('django', reason='the extra [web] is not installed')
pd = pytest.importorskip('pandas', reason='the extra [experiments] is not installed')

from browser import overflow, person, resized, served, violations  # noqa: E402
from study_client import RIGHT, STUDY, Person, copy_database, goal_name  # noqa: E402

from mirror_explainer.experiments.study.design import DONT_KNOW  # noqa: E402
from mirror_explainer.experiments.study.statistics import earliest_steps  # noqa: E402


def serve(database, port='0', *options):
    return served([*STUDY, 'serve', '--database', str(database), '--port', port, *options])


@pytest.fixture(scope='module')
def database(chromium, tmp_path_factory):
    """A study of three scenarios, in which nobody has taken part."""
    file = tmp_path_factory.mktemp('browser') / 'study.sqlite3'
    with serve(file, '0', '--scenarios', '3'):
        pass
    return file


@pytest.fixture(scope='module')
def server(database, tmp_path_factory):
    file = tmp_path_factory.mktemp('served') / 'study.sqlite3'
    copy_database(database, file)
    with serve(file) as running:
        yield running


def there(page):
    """Wait until the page is there, and the keyboard where it is to be, if at anything."""
    page.wait_for_load_state('load')
    page.wait_for_selector('button[autofocus]:focus, :root:not(:has(button[autofocus]))')


def press(page, *keys):
    """Press keys, of which the last one leads to another page, and wait until that is there."""
    for key in keys[:-1]:
        page.keyboard.press(key)
    with page.expect_navigation():
        page.keyboard.press(keys[-1])
    there(page)


def join(page, url):
    """Read the welcome page, agree, and begin, without a mouse."""
    page.goto(url)
    box = page.get_by_label('I have read this')
    while not box.evaluate('box => box == document.activeElement'):
        page.keyboard.press('Tab')
    press(page, 'Space', 'Enter')


def asked(page):
    """Whether the page asks for an answer; else it waits for the start of a scenario."""
    return page.locator('.question').count() == 1


def where(page):
    """Which step of which scenario is asked for."""
    scenario, step = (
        page.locator(f'input[name={name}]').get_attribute('value') for name in ('scenario', 'step')
    )
    return scenario, int(step)


def answer(page, choice):
    """Choose by a key (0 to 3), answer with Enter, and return what was chosen."""
    page.keyboard.press(str(choice + 1))
    words = page.locator('label:has(:checked) .goal').inner_text().strip()
    press(page, 'Enter')
    return goal_name(words) or DONT_KNOW


def check(page):
    """Answer the questions after the practice by the keyboard alone."""
    for index in (0, 1):
        right = page.locator(f'[name=check-{index}][value="{RIGHT[f"check-{index}"]}"]')
        right.focus()
        page.keyboard.press('Space')
    press(page, 'Enter')


def exported(file, folder):
    """Return what `export` writes, which is run in a process of its own."""
    command = [sys.executable, *STUDY, 'export', '--database', str(file), '--output', str(folder)]
    subprocess.run(command, check=True, capture_output=True, timeout=150)
    return pd.read_csv(folder / 'answers.csv')


def go_on(page, given, random):
    """Begin the scenario that is next; or answer its step at random, and note what was chosen."""
    if asked(page):
        step = where(page)
        given[step] = answer(page, random.randrange(4))
    elif page.locator('[action="/check"]').count():
        check(page)
    else:
        press(page, 'Enter')


def how_soon(met):
    """Return what a participant reads of when they were sure, in scenarios told alike."""
    sure = met['settled'][met['settled'] <= met['steps']]
    if sure.empty:
        return 'never sure'
    mean = f'{sure.mean():.1f}'.removesuffix('.0')
    return mean if len(sure) == len(met) else f'{mean} (sure in {len(sure)} of {len(met)})'


def test_a_whole_study_by_keyboard_through_reloads_and_a_killed_server(
    chromium, database, tmp_path
):
    file = tmp_path / 'study.sqlite3'
    copy_database(database, file)
    random, given = Random(5), {}
    with person(chromium, 'phone') as page:
        with serve(file) as first:
            join(page, first.url)
            while len(given) < 15 or not asked(page):
                go_on(page, given, random)
            before = where(page)
            page.reload()
            assert where(page) == before
            assert not page.errors, page.errors
            first.kill()
        with serve(file, first.port):
            page.reload()
            assert where(page) == before
            there(page)
            page.errors.clear()  # of the browser, where the kill cut off the page's icon
            while 'Thank you' not in page.title():
                go_on(page, given, random)
            assert violations(page) == []
            for _ in resized(page):
                assert overflow(page) <= 0
            rows = page.locator('tbody tr').all_inner_texts()

    assert len({scenario for scenario, _ in given}) == 6  # and the practice, and attention trials
    answers = exported(file, tmp_path)
    assert {
        (row['scenario'], row['step']): row['answer'] for row in answers.to_dict('records')
    } == {key: chosen for key, chosen in given.items() if key[0].startswith('scenario')}
    met = dict(tuple(earliest_steps(answers).groupby('strategy')))
    ways = {
        'informative': 'informative',
        'decreasing': 'from the end',
        'increasing': 'from the start',
    }
    for row, (strategy, way) in zip(rows, ways.items(), strict=True):
        assert row.split('\t')[:2] == [way, how_soon(met[strategy])]
    times = pd.read_csv(tmp_path / 'response_times.csv')
    assert (times['seconds_in_browser'] <= times['seconds']).all()


def test_two_people_at_once_are_kept_apart(chromium, server):
    with person(chromium) as one, person(chromium, 'tablet') as other:
        for page in (one, other):
            join(page, server.url)
            press(page, 'Enter')
        for step in range(1, 4):
            for page in (one, other):
                assert where(page) == ('practice', step)
                assert page.locator('.said li').count() == step
                answer(page, step % 4)
        answer(one, 0)
        assert (where(one)[1], where(other)[1]) == (5, 4)


def test_the_back_button_shows_what_is_due_now(chromium, server):
    with person(chromium) as page:
        join(page, server.url)
        press(page, 'Enter')
        answer(page, 1)

        page.go_back()

        page.wait_for_load_state()
        assert page.url.endswith('/study')
        assert where(page) == ('practice', 2)
        assert page.locator(':checked').count() == 0


def test_every_page_can_be_used_by_everyone(chromium, server):
    with person(chromium) as page:

        def check():
            for screen, _ in resized(page):
                assert overflow(page) <= 0
                if screen in ('desktop', 'phone'):  # the others are much the same to axe
                    assert violations(page) == []

        page.goto(server.url)
        check()
        join(page, server.url)
        check()
        press(page, 'Enter')
        check()
        answer(page, 0)
        page.emulate_media(color_scheme='dark')
        check()
        page.emulate_media(color_scheme='light', forced_colors='active')
        check()
        page.emulate_media(forced_colors='none')
        page.goto(f'{server.url}leave')
        check()
        page.goto(server.url)
        page.get_by_text('You have begun in another browser?').click()
        page.get_by_role('button', name='Go on', exact=True).click()
        page.wait_for_url('**/resume')
        check()  # with an error
        page.errors.clear()  # chromium reports the 400 that was asked for


def test_a_step_is_seen_whole_without_scrolling_and_nothing_seems_chosen(chromium, server):
    with person(chromium) as page:
        join(page, server.url)
        press(page, 'Enter')
        for step in range(7):
            assert page.locator(':checked').count() == 0
            assert not page.evaluate("document.activeElement.matches('input')")
            for screen, height in resized(page):
                if screen not in ('desktop', 'tablet', 'phone'):
                    continue
                tall = 'document.documentElement.scrollHeight - window.innerHeight'
                assert page.evaluate(tall) <= 0
                for what in ('.warehouse > svg', '#newest', 'button >> nth=0', '.choice >> nth=3'):
                    box = page.locator(what).bounding_box()
                    assert box['height'] > 10
                    assert box['y'] + box['height'] <= height
            answer(page, step % 4)


def test_still_the_same_gives_the_last_answer_again_by_key_and_by_mouse(
    chromium, database, tmp_path
):
    file = tmp_path / 'study.sqlite3'
    copy_database(database, file)
    with serve(file) as running, person(chromium) as page:
        join(page, running.url)
        press(page, 'Enter')
        assert page.locator('#same').count() == 0
        first = answer(page, 2)
        marked = page.locator('.choice.last').inner_text()
        assert page.locator('#same').text_content().startswith('Still the same: ')
        assert page.locator('#same .unseen').text_content().removeprefix(': ') in marked
        press(page, 's')
        with page.expect_navigation():
            page.get_by_role('button', name='Still the same').click()
        assert where(page) == ('practice', 4)
    with sqlite3.connect(file) as kept:
        query = 'SELECT answer FROM web_study_step WHERE answer IS NOT NULL ORDER BY step'
        assert kept.execute(query).fetchall() == [(first,)] * 3


STUDY_FILE = """
title: {en: "Robots", de: "Roboter"}
languages: [en, de]
minimum_age: 18
consent: "Please read **this** <script>alert(1)</script> [link](javascript:alert(1))"
keep_parameters: [PID]
closing_comment: true
questions: [{name: age, question: {en: Age, de: Alter}, kind: number}]
completion: {code: C0FFEE, return_to: "https://example.org/?pid={PID}"}
"""


def test_a_study_that_is_sent_out_in_german_from_consent_to_completion(
    chromium, database, tmp_path
):
    file, study = tmp_path / 'study.sqlite3', tmp_path / 'study.yaml'
    copy_database(database, file)
    study.write_text(STUDY_FILE)
    with serve(file, '0', '--study', str(study)) as running, person(chromium) as page:
        page.goto(f'{running.url}?PID=a%26b&other=1')
        page.get_by_role('link', name='Deutsch').click()
        assert page.locator('html').get_attribute('lang') == 'de'
        assert page.get_by_role('heading', level=1).inner_text() == 'Roboter'
        assert page.locator('main script').count() == 0
        assert page.locator('a[href^=javascript]').count() == 0
        page.get_by_label('bin mindestens 18 Jahre alt').check()
        page.get_by_role('button', name='Beginnen').click()
        page.get_by_role('button', name='Los').click()
        assert page.locator('#newest').inner_text().startswith('Ich ')
        assert violations(page) == []
        # A script goes on: the steps are as in the whole study above.
        [code] = [c['value'] for c in page.context.cookies() if c['name'] == 'study_participant']
        script = Person(running.url)
        script.post('resume', code=code)
        script.answer_the_rest(Random(1))
        page.reload()
        page.get_by_label('Alter').fill('dreißig')
        page.get_by_role('button', name='Absenden').click()
        assert 'ist keine Zahl' in page.get_by_role('alert').inner_text()
        page.get_by_label('Alter').fill('30')
        page.get_by_label('noch etwas sagen').fill('=1+1 <b>schön</b>')
        page.get_by_role('button', name='Absenden').click()
        assert page.get_by_text('Ihr Abschlusscode: C0FFEE').is_visible()
        back = page.get_by_role('link', name='Dorthin zurück')
        assert back.get_attribute('href') == 'https://example.org/?pid=a%26b'
        assert violations(page) == []
        page.errors.clear()  # chromium reports the 400 that was asked for
    exported(file, tmp_path)
    [row] = pd.read_csv(tmp_path / 'participants.csv').to_dict('records')
    assert (row['PID'], row['language'], row['age'], row['finished']) == ('a&b', 'de', 30, True)
    assert row['comment'].endswith('<b>schön</b>')
    assert not row['comment'].startswith('=')  # which a spreadsheet would obey


def test_no_page_has_to_run_a_script(chromium, server):
    from playwright.sync_api import expect  # where there is chromium, there is playwright

    with person(chromium, scripts=False) as page:
        page.goto(server.url)
        page.get_by_label('I have read this').check()
        page.get_by_role('button', name='Begin').click()
        page.get_by_role('button', name='Start').click()
        page.get_by_label("I don't know yet").check()
        page.get_by_role('button', name='Answer').click()
        expect(page.locator('.said li')).to_have_count(2)


def test_red_and_blue_differ_in_more_than_their_colour(chromium, server):
    with person(chromium) as page:
        join(page, server.url)
        for colour in ('red', 'blue'):
            items = page.locator(f'.warehouse .item.{colour}')
            assert items.count() >= 1
            for label in items.locator('text').all_text_contents():
                assert label.split()[0] == colour
        filled = "item => getComputedStyle(item.querySelector('circle, rect, path')).fill"
        assert 'stripes' in page.locator('.warehouse .item.blue').first.evaluate(filled)
        assert 'stripes' not in page.locator('.warehouse .item.red').first.evaluate(filled)
