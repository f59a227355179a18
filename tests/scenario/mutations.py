"""Ways to break a valid scenario file, for property tests."""

import copy
from typing import Any

import yaml
from hypothesis import strategies as st

JUNK: list[Any] = [
    None, True, False, 0, -1, 1, 2.5, -0.5, 1e308, -1e308, float("nan"), float("inf"),
    float("-inf"), 10**30, -(10**30), 5001, 10**6, "", "text", "anywhere", "1.5", "yes", "\u2028",
    [], [1], [1, 2], [2, 1], [1, 2, 3, 4], [[]], [[1, 2], [1, 2]], {}, {"type": "box"},
    {"type": "disc", "radius": 0}, {"type": "nonsense"}, {"type": ["box"]}, {"uniform": [2, 1]},
    {"uniform": 3}, {"uniform": ["a", 1]}, {"integers": [1, 2]}, {"integers": [0.5, 2]},
    {"choice": []}, {"choice": [1, "x"]}, {"normal": [0, -1, 0, 1]}, {"normal": [5, 1, 0, 1]},
    {"uniform": [0, 1], "choice": [1]}, {"type": "region", "region": {"type": "anywhere"}},
    {"a": {"b": {"c": [{"d": [1, [2, [3]]]}]}}},
]  # fmt: skip


def places(data: Any) -> list[tuple[Any, ...]]:
    """Paths of all nodes below the root."""
    found: list[tuple[Any, ...]] = []
    stack: list[tuple[tuple[Any, ...], Any]] = [((), data)]
    while stack:
        path, node = stack.pop()
        if isinstance(node, dict | list):
            items = node.items() if isinstance(node, dict) else enumerate(node)
            for key, child in items:
                found.append((*path, key))
                stack.append(((*path, key), child))
    return sorted(found, key=repr)


def mutate(data: Any, draw: Any) -> Any:
    """One random change."""
    data = copy.deepcopy(data)
    spots = places(data)
    if not spots:
        return data
    path = draw(st.sampled_from(spots))
    parent = data
    for key in path[:-1]:
        parent = parent[key]
    key = path[-1]
    match draw(st.sampled_from(["junk", "junk", "delete", "rename", "extra", "swap", "wrap"])):
        case "junk":
            parent[key] = copy.deepcopy(draw(st.sampled_from(JUNK)))
        case "delete":
            del parent[key]
        case "rename" if isinstance(parent, dict):
            parent[f"{key}s"] = parent.pop(key)
        case "extra" if isinstance(parent, dict):
            name = draw(st.text("abcxyz_é ", max_size=12))
            parent[name] = copy.deepcopy(draw(st.sampled_from(JUNK)))
        case "extra":
            parent.append(copy.deepcopy(parent[key]))
        case "swap":
            other = data
            for step in draw(st.sampled_from(spots)):
                try:
                    other = other[step]
                except (LookupError, TypeError):
                    break
            parent[key] = copy.deepcopy(other)
        case _:
            parent[key] = [parent[key]]
    return data


def text_of(data: Any) -> str:
    """As YAML without anchors."""

    class Plain(yaml.SafeDumper):
        def ignore_aliases(self, data: Any) -> bool:
            return True

    return yaml.dump(data, Dumper=Plain, allow_unicode=True)
