"""The study with people, over HTTP: what is kept of it, and what comes out of it."""

import io
import re
import sqlite3
import subprocess
import sys
import zipfile
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

import pytest

pytest.importorskip('django', reason='the extra [web] is not installed')
pd = pytest.importorskip('pandas', reason='the extra [experiments] is not installed')

from browser import served  # noqa: E402
from study_client import CHOICES, RIGHT, STUDY, Person, copy_database  # noqa: E402

from mirror_explainer.experiments.study import statistics as study_statistics  # noqa: E402
from mirror_explainer.experiments.study.design import (  # noqa: E402
    DONT_KNOW,
    PEOPLE,
    Answer,
    assignment,
    heard,
    presentation_order,
    strategies_for,
)
from mirror_explainer.experiments.study.observers import KINDS  # noqa: E402
from mirror_explainer.experiments.study.plans import plan_scenarios  # noqa: E402
from mirror_explainer.experiments.study.report import results  # noqa: E402
from mirror_explainer.experiments.study.scenarios import scenarios  # noqa: E402
from mirror_explainer.experiments.study.statistics import answer_table  # noqa: E402
from mirror_explainer.experiments.study.warehouse_floor import read_floor  # noqa: E402

SCENARIOS, SEED = 4, 109
LISTENERS = ('planner', 'open')


# The commands, with a resampling that takes less time than the thousands of a real report.
COMMAND = """
from mirror_explainer.experiments.study import statistics as study_statistics, user_study
study_statistics.RESAMPLES = 99
raise SystemExit(user_study.main())
"""


def run(*arguments):
    return subprocess.run(
        [sys.executable, '-c', COMMAND, *map(str, arguments)],
        capture_output=True,
        text=True,
        timeout=150,
    )


@dataclass(frozen=True)
class Study:
    """A study that is served: its file, which any test may add people to, and its address."""

    file: Path
    url: str

    def snapshot(self, file):
        """Copy the database as it is now."""
        copy_database(self.file, file)
        return file

    def kept(self, code):
        """What somebody answered, straight from the file."""
        with sqlite3.connect(self.file) as database:
            return database.execute(
                'SELECT scenario, step, answer FROM web_study_participant AS p '
                'JOIN web_study_step AS s ON s.participant_id = p.id '
                'WHERE answer IS NOT NULL AND code = ?',
                [code],
            ).fetchall()

    def number(self, column, value):
        """Which of all participants somebody is."""
        with sqlite3.connect(self.file) as database:
            query = f'SELECT number FROM web_study_participant WHERE {column} = ?'
            found = database.execute(query, [value]).fetchone()
        return found and found[0]


@pytest.fixture(scope='module')
def study(tmp_path_factory):
    file = tmp_path_factory.mktemp('study') / 'study.sqlite3'
    texts = file.with_suffix('.yaml')
    texts.write_text(f'{{scenarios: {SCENARIOS}, seed: {SEED}, listeners: {list(LISTENERS)}}}')
    arguments = ['--study', str(texts), '--port', '0']
    with served([*STUDY, 'serve', '--database', str(file), *arguments]) as server:
        yield Study(file, server.url)


@pytest.fixture(scope='module')
def empty(study, tmp_path_factory):
    """A database in which nobody has taken part: the first fixture that touches the study."""
    return study.snapshot(tmp_path_factory.mktemp('empty') / 'study.sqlite3')


@pytest.fixture(scope='module')
def finished(study, empty, tmp_path_factory):
    """A database in which three took part at once, and what each of them chose."""
    with ThreadPoolExecutor() as pool:
        scripts = list(pool.map(lambda seed: Person(study.url).take_part(seed), range(3)))
    Person(study.url).join()  # and a fourth, who does not go on
    file = study.snapshot(tmp_path_factory.mktemp('finished') / 'study.sqlite3')
    numbers = {name: study.number('name', name) for _, name in scripts}
    scripts.sort(key=lambda script: numbers[script[1]])
    return file, {name: given for given, name in scripts}


@pytest.fixture(scope='module')
def exported(finished, tmp_path_factory):
    """The folder that `export` writes of the three."""
    folder = tmp_path_factory.mktemp('exported')
    ended = run('export', '--database', finished[0], '--output', folder)
    assert ended.returncode == 0, ended.stderr
    assert '3 finished, 1 have not' in ended.stderr
    return folder


@pytest.fixture
def person(study, finished):
    """Somebody at the first step of the practice."""
    someone = Person(study.url)
    someone.join()
    someone.post('start')
    return someone


# What comes out


def test_the_export_gives_exactly_the_statistics_of_the_scripts(finished, exported, monkeypatch):
    monkeypatch.setattr(study_statistics, 'RESAMPLES', 99)
    planned, _ = plan_scenarios(scenarios(read_floor(), SCENARIOS, SEED))
    scripted = []
    rows = assignment(3, SCENARIOS, SEED, strategies_for(LISTENERS))
    for (name, given), strategies in zip(finished[1].items(), rows, strict=True):
        for item, strategy in zip(planned, strategies, strict=True):
            steps = heard(item, strategy)
            for step, positions in enumerate(steps, start=1):
                page, choice = given[item.scenario.name, step]
                assert sorted(page.said) == sorted(item.model.sentences[i] for i in positions)
                scripted.append(
                    Answer(
                        participant=name,
                        observer=PEOPLE,
                        scenario=item.scenario.name,
                        strategy=strategy,
                        step=step,
                        steps=len(steps),
                        plan_length=len(item.plan.actions),
                        said=' '.join(map(str, positions)),
                        goal=item.scenario.goals[item.scenario.goal].name,
                        answer=DONT_KNOW if choice == '?' else page.goals[int(choice)],
                    )
                )
    expected = results(answer_table(scripted), SEED)

    found = results(pd.read_csv(exported / 'answers.csv', dtype={'said': str}), SEED)

    for table in ('answers', 'curves', 'earliest', 'tests'):
        pd.testing.assert_frame_equal(
            getattr(found, table), getattr(expected, table), check_dtype=False, check_exact=True
        )


def test_people_meet_the_scenarios_in_their_own_random_order(finished, exported):
    times = pd.read_csv(exported / 'response_times.csv')

    for number, (name, given) in enumerate(finished[1].items()):
        met = list(dict.fromkeys(scenario for scenario, _ in given))
        one, two, *others = presentation_order(SCENARIOS, number, SEED)
        assert met == [
            'practice', f'scenario-{one + 1}', 'attention-1', f'scenario-{two + 1}',
            'attention-2', *(f'scenario-{other + 1}' for other in others),
        ]  # fmt: skip
        of_one = times[times['participant'] == name]
        assert list(dict.fromkeys(of_one['scenario'])) == met
        assert len(of_one) == len(given)
    assert (times['seconds'] > 0).all()
    assert times['finished'].all()  # the fourth has not answered anything


def test_the_report_sets_people_beside_simulated_listeners(finished, tmp_path):
    ended = run('analyse', '--database', finished[0], '--output', tmp_path)

    assert ended.returncode == 0, ended.stderr
    report = (tmp_path / 'report.md').read_text()
    for observer in (PEOPLE, *KINDS):
        assert f'| {observer} ' in report
    assert 'took part in a browser; 3 finished' in report
    assert '## Response times' in report
    assert f'| {PEOPLE} | settled | informative-open | informative ' in ' '.join(report.split())
    assert 'nan' not in report
    assert (tmp_path / 'user_study.png').read_bytes().startswith(b'\x89PNG')
    answers = pd.read_csv(tmp_path / 'answers.csv', keep_default_na=False)
    assert set(answers['observer']) == {PEOPLE, *KINDS}
    assert set(zip(answers['strategy'], answers['listener'], strict=True)) == {
        ('informative', 'planner'), ('informative-open', 'open'),
        ('increasing', ''), ('decreasing', ''),
    }  # fmt: skip


def test_a_person_reads_how_soon_they_were_sure_in_the_end(study, finished):
    someone = Person(study.url)
    someone.take_part(7)

    assert 'How soon you were sure' in someone.page.html
    assert someone.page.html.count('<th scope="row"') == 3
    assert someone.page.html.count('class="strip"') == SCENARIOS
    assert someone.get('').html.count('Go on where you were') == 1


# Step by step


def test_each_step_says_one_sentence_more_and_nothing_of_what_is_to_come(person):
    heard = []
    for number in range(1, 4):
        page = person.page
        assert (page.step, page.said[:-1], len(page.said)) == (number, heard, number)
        assert len(page.goals) == 3
        for word in ('informative', 'increasing', 'decreasing'):
            assert word not in page.html
        heard = page.said
        person.answer('?')


def test_an_answer_once_given_stays_however_often_it_is_sent(study, person):
    first = person.page
    copies = [Person(study.url) for _ in range(8)]
    for copy in copies:
        for cookie in person.cookies:
            copy.cookies.set_cookie(cookie)
        copy.get('study')

    def send(index):
        choice = CHOICES[index % len(CHOICES)]
        return copies[index].answer(choice, scenario=first.scenario, step=first.step)

    with ThreadPoolExecutor(len(copies)) as pool:
        pages = list(pool.map(send, range(len(copies))))

    [given] = study.kept(person.code)
    assert {page.step for page in pages} == {2}
    assert person.answer('1').step == 2  # from the page of the first step, still open
    assert study.kept(person.code) == [given]


def test_a_page_that_is_open_twice_is_told_that_it_is_old(person):
    first = person.page
    assert person.answer('0').status == 200
    assert 'from an older page' not in person.page.html

    person.page = first
    again = person.answer('0')  # the same: somebody pressed twice
    assert (again.status, 'from an older page' in again.html) == (200, False)
    person.page = first
    other = person.answer('1')
    assert (other.status, 'from an older page' in other.html) == (400, True)
    assert other.step == 2


def test_an_answer_to_a_step_that_is_not_due_is_ignored(person):
    for step in ('2', '0', '-1', 'x', '9' * 5000):
        assert person.answer('0', step=step).step == 1
    assert person.answer('0', scenario='scenario-1').step == 1
    assert person.answer('0', scenario="'; DROP TABLE web_study_step; --").step == 1


@pytest.mark.parametrize('choice', ['', '3', '-1', 'red'])
def test_an_answer_that_is_none_of_the_four_is_asked_for_again(person, choice):
    page = person.answer(choice)

    assert (page.status, page.step) == (400, 1)
    assert 'Choose one of the four answers.' in page.html
    assert page.title.startswith('Error: ')


def test_wrong_answers_about_the_rules_are_explained_and_asked_again_and_counted(study, person):
    while 'action="/check"' not in person.page.html:
        person.answer('0')
    assert 'The robot&#x27;s goal was' in person.page.html
    page = person.post('start')  # which does not lead around the questions
    assert 'action="/check"' in page.html

    assert person.post('check', **{**RIGHT, 'check-1': '2'}).status == 400
    assert 'Not quite. It can leave only' in person.page.html
    assert person.post('check', **{'check-0': '1'}).status == 400
    assert person.post('check', **RIGHT).title == 'Encounter 1 of 6'
    with sqlite3.connect(study.file) as database:
        query = 'SELECT checks, checked FROM web_study_participant WHERE code = ?'
        assert database.execute(query, [person.code]).fetchone() == (2, 1)


def test_the_time_that_a_browser_took_is_kept_where_it_can_be_one(study, person):
    for told in ('1.5', 'nan', '-1', '1e9', '<b>', ''):
        person.answer('0', in_browser=told)
    with sqlite3.connect(study.file) as database:
        query = (
            'SELECT in_browser FROM web_study_step AS s JOIN web_study_participant AS p '
            'ON s.participant_id = p.id WHERE code = ? AND answer IS NOT NULL ORDER BY step'
        )
        kept = [value for (value,) in database.execute(query, [person.code])]
    assert kept == [1.5, None, None, None, None, None]


def tells(sentence, goal):
    """Whether the sentence of an attention trial has all that the goal has."""
    items, door = goal.split(', ')
    return all(part in sentence for part in (*items.split(' and '), door))


def test_the_export_tells_of_each_person_how_it_went_and_what_to_doubt(exported, finished):
    people = pd.read_csv(exported / 'participants.csv').set_index('participant')

    assert list(people['finished']) == [True] * 3 + [False]
    assert set(people.index[:3]) == set(finished[1])
    for name, given in finished[1].items():
        trials = [given[f'attention-{i}', 1] for i in (1, 2)]
        right = sum(
            choice != '?' and tells(page.said[0], page.goals[int(choice)])
            for page, choice in trials
        )
        row = people.loc[name]
        assert (row['attention_right'], row['attention_trials'], row['checks']) == (right, 2, 1)
        assert ('failed attention' in str(row['flags'])) == (right < 2)
        assert 'too fast' in row['flags']  # scripts are


def test_the_order_of_the_choices_is_exported_as_it_was_shown(exported, finished):
    times = pd.read_csv(exported / 'response_times.csv')

    for row in times.to_dict('records'):
        page, choice = finished[1][row['participant']][row['scenario'], row['step']]
        assert row['shown'].split(' | ') == page.goals
        assert (row['answer'] == DONT_KNOW) == (choice == '?')
        if choice != '?':
            assert row['position'] == int(choice) + 1
        if row['step'] == 1 and row['strategy'] == 'attention':
            assert tells(page.said[0], page.goals[row['right_position'] - 1])


# The researcher


def test_the_researchers_page_needs_its_key_and_has_the_numbers_and_all_tables(finished, study):
    with sqlite3.connect(study.file) as database:
        [key] = database.execute('SELECT "key" FROM web_study_study').fetchone()
    someone = Person(study.url)
    for path in ('researcher', 'researcher?key=', 'researcher?key=wrong', 'researcher/study.zip'):
        assert someone.get(path).status == 404

    page = someone.get(f'researcher?key={key}')
    assert page.status == 200
    assert re.search(r'<dt>finished</dt><dd>[3-9]', page.html)
    assert '<dt>dropped out</dt><dd>0' in page.html
    assert set(finished[1]) <= set(re.findall('p-[a-z0-9]{6}', page.html))
    archive = zipfile.ZipFile(io.BytesIO(someone.bytes('researcher/study.zip')))
    assert sorted(archive.namelist()) == [
        'answers.csv', 'participants.csv', 'response_times.csv',
    ]  # fmt: skip


def test_nobody_takes_part_without_consent(study):
    someone = Person(study.url)
    page = someone.post('join')

    assert page.status == 400
    assert 'Tick the box if you agree' in page.html
    assert someone.get('study').title == 'What is the robot up to?'
    assert 'Go on where you were' not in someone.page.html


def test_a_form_that_is_sent_twice_makes_one_participant(study):
    someone = Person(study.url)
    welcome = someone.page
    first = someone.join()
    code = someone.code

    someone.page = welcome
    someone.join()

    assert someone.code == code
    assert someone.page.title == first.title == 'Practice'


@pytest.mark.parametrize('code', ['', 'x', 'aaaa-bbbb', 'aaaa-bbbb-ccc1', '../-aaaa-aaaa'])
def test_nobody_makes_up_a_code(study, code):
    assert Person(study.url).post('join', consent='on', new=code).status == 400


def test_a_code_leads_back_in_another_browser(person, study):
    person.answer('0')
    elsewhere = Person(study.url)

    page = elsewhere.post('resume', code=f' {person.code.upper()} ')

    assert (page.scenario, page.step) == (person.page.scenario, 2)


@pytest.mark.parametrize(('code', 'reason'), [('', 'Give your code.'), ('<b>', '&lt;b&gt;')])
def test_a_wrong_code_is_told_so(study, code, reason):
    page = Person(study.url).post('resume', code=code)

    assert page.status == 400
    assert reason in page.html


def test_stopping_keeps_the_answers_and_frees_the_browser(person, study):
    person.answer('0')
    code = person.code

    person.get('leave')
    assert person.post('leave', answers='keep').title == 'What is the robot up to?'
    assert person.get('study').title == 'What is the robot up to?'
    assert person.post('resume', code=code).step == 2


def test_answers_are_deleted_on_request_and_the_place_is_given_to_the_next(study, person):
    person.answer('0')
    code = person.code
    number = study.number('code', code)

    person.get('leave')
    person.post('leave', answers='delete')

    assert study.kept(code) == []
    assert person.post('resume', code=code).status == 400
    person.join()
    assert study.number('code', person.code) == number


# The database


@pytest.mark.parametrize(
    ('arguments', 'reason'),
    [
        (
            ['serve', '--seed', '4'],
            'its study has 4 scenarios of seed 109, with words for listeners of kind planner '
            'and open, for good',
        ),
        (['analyse'], 'nobody has finished the study yet'),
    ],
)
def test_what_a_database_cannot_do_is_told(empty, arguments, reason):
    ended = run(*arguments, '--database', empty)

    assert ended.returncode == 2
    assert f'user_study: {empty}: {reason}' in ended.stderr


def test_a_file_that_is_no_database_is_left_alone(tmp_path):
    file = tmp_path / 'notes.txt'
    file.write_text('not a database, but long enough to be taken for one' * 100)

    ended = run('serve', '--database', file)

    assert ended.returncode == 2
    assert f'{file}: it cannot be used as a database' in ended.stderr
    assert file.read_text().startswith('not a database')


def test_the_database_of_something_else_is_left_alone(tmp_path):
    file = tmp_path / 'other.sqlite3'
    with sqlite3.connect(file) as other:
        other.execute('CREATE TABLE precious (thing TEXT)')
    before = file.read_bytes()

    ended = run('export', '--database', file)

    assert ended.returncode == 2
    assert f"{file}: it is not a study's. Name another --database." in ended.stderr
    assert file.read_bytes() == before


def test_a_database_that_is_not_there_is_made_by_serve_alone(tmp_path):
    ended = run('export', '--database', tmp_path / 'none.sqlite3')

    assert ended.returncode == 2
    assert 'there is no such file. "serve" makes one.' in ended.stderr
    assert list(tmp_path.iterdir()) == []
