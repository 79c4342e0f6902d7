"""The table of parameters in the documentation is that of the node."""

from pathlib import Path

import pytest

DOCS = Path(__file__).parents[2] / 'docs'


def row(name: str, default: object, descriptor: object) -> str:
    """Return the table's row of a parameter."""
    between = [*descriptor.integer_range, *descriptor.floating_point_range]
    allowed = f'{between[0].from_value} … {between[0].to_value}' if between else ''
    if descriptor.additional_constraints:
        allowed = descriptor.additional_constraints
    star = '' if descriptor.read_only else ' *'
    shown = f'`{default}`' if default != '' else ''
    if isinstance(default, bool):
        shown = f'`{str(default).lower()}`'
    return f'| `{name}`{star} | {shown} | {allowed} | {descriptor.description} |'


def test_the_table_of_parameters_is_the_nodes():
    pytest.importorskip('rclpy', reason='needs ROS 2')
    from mirror_explainer.node.parameters import PARAMETERS

    table = '\n'.join(row(*parameter) for parameter in PARAMETERS)
    page = (DOCS / 'parameters.md').read_text()
    assert table in page, f'docs/parameters.md lacks the table as it is now:\n{table}'
