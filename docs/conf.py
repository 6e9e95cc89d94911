from importlib.metadata import version as installed_version

project = "trecsim"
author = "the trecsim authors"
copyright = "the trecsim authors, Apache-2.0"
version = release = installed_version("mc3d-trecsim")

extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.autosummary",
    "sphinx.ext.viewcode",
    "numpydoc",
]
exclude_patterns = ["_build", "report"]  # report: see benchmarks/technical_report.py
templates_path = ["_templates"]
default_role = "literal"  # names in docstrings; most of them are arguments and units

myst_enable_extensions = ["deflist", "dollarmath"]
myst_heading_anchors = 3

autosummary_generate = True
autosummary_ignore_module_all = False
autodoc_member_order = "bysource"
autodoc_typehints = "signature"
# The documentation is built without the heavy extras.
autodoc_mock_imports = ["av", "onnxruntime", "openvino", "rtmlib"]
numpydoc_show_class_members = False
numpydoc_class_members_toctree = False

html_theme = "pydata_sphinx_theme"
html_title = "trecsim"
html_show_sourcelink = False
html_theme_options = {
    "show_toc_level": 2,
    "navigation_with_keys": False,
    "secondary_sidebar_items": ["page-toc"],
    "footer_start": ["copyright"],
    "footer_end": [],
}
