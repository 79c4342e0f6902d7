"""The study in a real browser: by keyboard alone, through a kill, two at once, for all."""

import subprocess
import sys
from random import Random

import pytest

pytest.importorskip('django', reason='the extra [web] is not installed')
pd = pytest.importorskip('pandas', reason='the extra [experiments] is not installed')

from browser import SCREENS, overflow, person, served, violations  # noqa: E402
from study_client import STUDY, copy_database, goal_name  # noqa: E402

from mirror_explainer.experiments.study.design import DONT_KNOW  # noqa: E402


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
def server(database):
    with serve(database) as running:
        yield running


def focused(page):
    """Wait until the page is there, and the keyboard where it is to be; the last has no such."""
    page.wait_for_selector('[autofocus]:focus, .chart')


def press(page, *keys):
    """Press keys, of which the last one leads to another page, and wait until that is there."""
    for key in keys[:-1]:
        page.keyboard.press(key)
    with page.expect_navigation():
        page.keyboard.press(keys[-1])
    focused(page)


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
    """Choose by the arrow keys (0 to 3), answer with Enter, and return what was chosen."""
    keys = ['ArrowDown'] * choice or ['Space']
    for key in keys:
        page.keyboard.press(key)
    words = page.locator('label:has(:checked)').inner_text().strip()
    press(page, 'Enter')
    return goal_name(words) or DONT_KNOW


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
    else:
        press(page, 'Enter')


@pytest.mark.timeout(900)  # some 40 pages and the planning before them, on a busy machine
def test_a_whole_study_by_keyboard_through_reloads_and_a_killed_server(
    chromium, database, tmp_path
):
    file = tmp_path / 'study.sqlite3'
    copy_database(database, file)
    random, given = Random(5), {}
    with person(chromium) as page:
        with serve(file) as first:
            join(page, first.url)
            while len(given) < 20 or not asked(page):
                go_on(page, given, random)
            before = where(page)
            page.reload()
            assert where(page) == before
            first.kill()
        with serve(file, first.port):
            page.reload()
            assert where(page) == before
            focused(page)
            while 'Thank you' not in page.title():
                go_on(page, given, random)
            assert violations(page) == []
            for width, height in SCREENS.values():
                page.set_viewport_size({'width': width, 'height': height})
                assert overflow(page) <= 0
            cells = page.locator('tbody td').all_inner_texts()

    assert len({scenario for scenario, _ in given}) == 4  # and the practice
    answers = exported(file, tmp_path)
    assert {
        (row['scenario'], row['step']): row['answer'] for row in answers.to_dict('records')
    } == {key: chosen for key, chosen in given.items() if key[0] != 'practice'}
    # The first row is after 10 % of the plan: step 1, whatever the plan's length up to 14.
    early = answers[(answers['step'] == 1) & answers['predicted']]
    for cell, strategy in zip(cells, ('informative', 'increasing', 'decreasing'), strict=False):
        mine = early[early['strategy'] == strategy]
        count = f'({mine["correct"].sum()} of {len(mine)})' if len(mine) else 'no choice'
        assert count in cell


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


@pytest.mark.parametrize('screen', list(SCREENS))
def test_every_page_can_be_used_by_everyone(chromium, server, screen):
    with person(chromium, screen) as page:

        def check():
            assert screen == 'tablet' or violations(page) == []  # much the same as a desktop's
            assert overflow(page) <= 0

        page.goto(server.url)
        check()
        join(page, server.url)
        check()
        press(page, 'Enter')
        check()
        answer(page, 0)
        page.get_by_text('The picture in words').click()
        check()
        page.goto(f'{server.url}leave')
        check()
        page.goto(server.url)
        page.get_by_role('button', name='Go on').click()
        page.wait_for_url('**/resume')
        check()  # with an error
        page.errors.clear()  # chromium reports the 400 that was asked for


def test_no_page_has_to_run_a_script(chromium, server):
    from playwright.sync_api import expect  # where there is chromium, there is playwright

    with person(chromium, scripts=False) as page:
        page.goto(server.url)
        expect(page.locator('script')).to_have_count(0)
        page.get_by_label('I have read this').check()
        page.get_by_role('button', name='Begin').click()
        page.get_by_role('button', name='Start').click()
        page.get_by_label("I don't know yet").check()
        page.get_by_role('button', name='Answer').click()
        expect(page.locator('.said li')).to_have_count(2)


def test_red_and_blue_differ_in_more_than_their_colour(chromium, server):
    with person(chromium) as page:
        page.goto(server.url)
        for colour in ('red', 'blue'):
            items = page.locator(f'.item.{colour}')
            assert items.count() >= 1
            for label in items.locator('text').all_text_contents():
                assert label.split()[0] == colour
        filled = "item => getComputedStyle(item.querySelector('circle, rect, path')).fill"
        assert 'stripes' in page.locator('.item.blue').first.evaluate(filled)
        assert 'stripes' not in page.locator('.item.red').first.evaluate(filled)
