"""Numbers among a command's options, as they are read and as they are refused."""

from argparse import ArgumentTypeError

import pytest

from mirror_explainer.commands.options import number, whole


def test_numbers_within_the_limits_are_read_the_limits_included() -> None:
    assert [whole(2)('2'), number(0)('0'), number(0, 1)('1'), number(0, above=True)('1e-3')] == [
        2,
        0.0,
        1.0,
        0.001,
    ]


@pytest.mark.parametrize(
    ('reader', 'text', 'limits'),
    [
        (whole(2), '1', 'whole number from 2 up'),
        (whole(0), '-1', 'whole number from 0 up'),
        (whole(0), '²', 'whole number from 0 up'),
        (number(0), 'nan', 'number from 0 up'),
        (number(0), 'inf', 'number from 0 up'),
        (number(0, 1), '1.5', 'number from 0 to 1'),
        (number(0, above=True), '0', 'number above 0'),
    ],
)
def test_what_is_no_such_number_is_refused_with_the_limits(reader, text, limits) -> None:
    with pytest.raises(ArgumentTypeError, match=f'^"{text}" is no {limits}$'):
        reader(text)
