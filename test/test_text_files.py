"""Files that are read and watched."""

import os
import stat
from pathlib import Path

import pytest

from mirror_explainer.errors import InputError
from mirror_explainer.text_files import TextFiles, read_text, write_text


@pytest.mark.parametrize(
    ('path', 'cure'),
    [
        ('~/user_model.yaml', 'Write the whole path, from "/" on: "~" is not expanded here.'),
        (
            'no/user_model.yaml',
            'Check the path: unless it is absolute, it begins where the program was started.',
        ),
        ('/nowhere/user_model.yaml', ''),
    ],
)
def test_a_path_to_nothing_has_what_to_check_about_it(path: str, cure: str) -> None:
    with pytest.raises(InputError) as refused:
        read_text(path)

    assert refused.value.reason == 'the file cannot be read: No such file or directory'
    assert refused.value.cure == cure


def test_a_file_that_cannot_be_written_is_named(tmp_path: Path) -> None:
    write_text(str(tmp_path / 'said.txt'), 'Ça va.')

    assert (tmp_path / 'said.txt').read_text('utf-8') == 'Ça va.'
    with pytest.raises(InputError, match='^/nowhere/said.txt: the file cannot be written: No suc'):
        write_text('/nowhere/said.txt', '')
    with pytest.raises(InputError, match='the file cannot be written: embedded null byte'):
        write_text('a\0b', '')


def test_a_change_shows_once_even_if_the_file_was_read_again_before_anybody_looked(
    tmp_path: Path,
) -> None:
    path = tmp_path / 'model.yaml'
    path.write_text('first')
    files = TextFiles()
    files.read(str(path))
    before = files.changed()
    path.write_text('second one')

    text = files.read(str(path))

    assert text == 'second one'
    assert [before, files.changed(), files.changed()] == [False, True, False]


def test_a_file_that_would_be_waited_for_is_no_text_yet(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    # As some files in /proc, which count as regular ones.
    path = tmp_path / 'model.yaml'
    os.mkfifo(path)
    monkeypatch.setattr(stat, 'S_ISREG', lambda mode: True)
    reader = os.open(path, os.O_RDONLY | os.O_NONBLOCK)
    writer = os.open(path, os.O_WRONLY)
    try:
        with pytest.raises(InputError, match='there is nothing in it yet'):
            read_text(str(path))
    finally:
        os.close(reader)
        os.close(writer)
