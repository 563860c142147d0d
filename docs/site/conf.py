"""Sphinx's configuration of the site. scripts/docs sets OCTOPAIR_DOCS, the folder of the build."""
import os
import pathlib
import re
import sys

SITE = pathlib.Path(__file__).parent
sys.path.insert(0, str(SITE))
ROOT = SITE.parents[1]

project = "octopair"
version = release = re.search(r"project\(octopair VERSION ([\d.]+)", (ROOT / "CMakeLists.txt").read_text(encoding="utf-8"))[1]
copyright = "the authors of octopair; BSD-3-Clause"

extensions = ["myst_parser", "breathe", "mend_theme"]
myst_enable_extensions = ["deflist"]
myst_heading_anchors = 4
# A file that a page shows, such as a template, may not follow its language to the letter.
suppress_warnings = ["misc.highlighting_failure"]

breathe_projects = {"octopair": os.environ["OCTOPAIR_DOCS"] + "/doxygen/xml"}
breathe_default_project = "octopair"
breathe_domain_by_extension = {"hpp": "cpp", "h": "c"}
breathe_show_include = False
cpp_id_attributes = ["OCTOPAIR_EXPORT"]

smartquotes = False

html_theme = "furo"
html_title = f"octopair {version}"
html_static_path = [str(SITE / "_static")]
html_css_files = ["style.css"]
html_copy_source = False
html_show_sourcelink = False
html_last_updated_fmt = None
html_theme_options = {
    "light_css_variables": {"color-brand-primary": "#0b5d8a", "color-brand-content": "#0b5d8a"},
    "dark_css_variables": {"color-brand-primary": "#5ab4e6", "color-brand-content": "#5ab4e6"},
}
pygments_style = "friendly"
pygments_dark_style = "monokai"
