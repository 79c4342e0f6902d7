"""The documentation as a site: `python3 -m sphinx -W -b html docs docs/_build`, extra [docs]."""

import importlib.util
import sys
from pathlib import Path
from xml.etree import ElementTree

ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT))

project = 'mirror_explainer'
author = 'mirror_explainer maintainers'
copyright = author
version = release = ElementTree.parse(ROOT / 'package.xml').findtext('version')

extensions = ['myst_parser', 'sphinx.ext.autodoc', 'sphinxcontrib.mermaid']
exclude_patterns = ['_build']
myst_heading_anchors = 4  # links to headings, as GitHub has them
myst_fence_as_directive = ['mermaid']  # which GitHub draws, too

default_role = 'code'  # docstrings have `names` in single backticks
autodoc_member_order = 'bysource'
autodoc_typehints_format = 'short'
autodoc_mock_imports = [
    name
    for name in ('ament_index_python', 'rclpy', 'std_msgs')
    if importlib.util.find_spec(name) is None
]

html_theme = 'furo'
html_title = 'mirror_explainer'
