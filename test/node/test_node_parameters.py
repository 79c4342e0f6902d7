"""The node's parameters are the settings of the core, and the example file has them all."""

from dataclasses import asdict
from pathlib import Path

import pytest
import yaml
from conftest import WAREHOUSE

pytest.importorskip('rclpy', reason='needs ROS 2')

from mirror_explainer.node.inputs import Configuration
from mirror_explainer.node.parameters import PARAMETERS, configuration

EXAMPLE = WAREHOUSE.parent / 'explainer.yaml'


def test_the_example_file_has_every_parameter_with_its_default_and_says_which_act_at_once() -> (
    None
):
    text = Path(EXAMPLE).read_text()
    given = yaml.safe_load(text)['/**']['ros__parameters']
    limits = text.index('# What is larger')
    marked = {
        line.split(':')[0].strip()
        for line in text.splitlines()
        if '(run time)' in line or text.find(line) > limits
    }

    assert given == {name: default for name, default, _ in PARAMETERS}
    assert marked & given.keys() == {name for name, _, d in PARAMETERS if not d.read_only}


def test_the_defaults_of_the_parameters_are_those_of_the_settings() -> None:
    defaults = {name: default for name, default, _ in PARAMETERS}

    assert configuration(defaults.__getitem__) == Configuration()
    assert sum(map(len, asdict(Configuration()).values())) == len(defaults)


def test_every_parameter_says_what_it_is_and_every_number_its_range() -> None:
    for name, default, descriptor in PARAMETERS:
        assert descriptor.description, name
        if isinstance(default, int | float) and not isinstance(default, bool):
            (between,) = [*descriptor.integer_range, *descriptor.floating_point_range]
            assert between.from_value <= default <= between.to_value, name
