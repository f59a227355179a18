"""How to cite benchnav and the paper that it follows."""

from benchnav.store.runs.manifest import versions

TITLE = "benchnav: a benchmark for crowd navigation in unknown and dynamic environments"
PAPER = """\
@article{sun2019crowd,
  title   = {Crowd Navigation in an Unknown and Dynamic Environment Based on
             Deep Reinforcement Learning},
  author  = {Sun, L. and Zhai, J. and Qin, W.},
  journal = {IEEE Access},
  year    = {2019},
  url     = {https://doaj.org/article/0dcb806d76a14c07bb197d938fe8f173},
}"""


def software(year: str) -> str:
    """Return the BibTeX entry of the installed benchnav."""
    return f"""\
@software{{benchnav,
  title   = {{{TITLE}}},
  author  = {{{{The benchnav authors}}}},
  version = {{{versions().get("benchnav", "")}}},
  year    = {{{year}}},
}}"""
