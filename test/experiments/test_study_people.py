"""The study with people, over HTTP: what is kept of it, and what comes out of it."""

import sqlite3
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

import pytest

pytest.importorskip('django', reason='the extra [web] is not installed')
pd = pytest.importorskip('pandas', reason='the extra [experiments] is not installed')

from browser import served  # noqa: E402
from study_client import CHOICES, STUDY, Person, copy_database  # noqa: E402

from mirror_explainer.experiments.study import statistics as study_statistics  # noqa: E402
from mirror_explainer.experiments.study.design import (  # noqa: E402
    DONT_KNOW,
    PEOPLE,
    Answer,
    assignment,
    presentation_order,
    verbalizations,
)
from mirror_explainer.experiments.study.observers import KINDS  # noqa: E402
from mirror_explainer.experiments.study.plans import plan_scenarios  # noqa: E402
from mirror_explainer.experiments.study.report import results  # noqa: E402
from mirror_explainer.experiments.study.scenarios import scenarios  # noqa: E402
from mirror_explainer.experiments.study.statistics import answer_table  # noqa: E402
from mirror_explainer.experiments.study.warehouse_floor import read_floor  # noqa: E402

SCENARIOS, SEED = 3, 109


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
    arguments = ['--scenarios', str(SCENARIOS), '--seed', str(SEED), '--port', '0']
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
    rows = assignment(3, SCENARIOS, SEED)
    for (name, given), strategies in zip(finished[1].items(), rows, strict=True):
        for item, strategy in zip(planned, strategies, strict=True):
            steps = verbalizations(item.model, strategy)
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
        order = presentation_order(SCENARIOS, number, SEED)
        assert met == ['practice', *(f'scenario-{index + 1}' for index in order)]
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
    assert 'nan' not in report
    assert (tmp_path / 'user_study.png').read_bytes().startswith(b'\x89PNG')
    assert set(pd.read_csv(tmp_path / 'answers.csv')['observer']) == {PEOPLE, *KINDS}


def test_a_person_reads_their_own_hit_ratios_in_the_end(study, finished):
    someone = Person(study.url)
    someone.take_part(7)

    assert 'Your hit ratio' in someone.page.html
    assert someone.page.html.count('<th scope="row"') == 10
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
        (['serve', '--seed', '4'], 'its study has 3 scenarios of seed 109, for good'),
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
