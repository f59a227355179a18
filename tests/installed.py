"""Plugins that a test installs, as other processes find them too."""


def install(monkeypatch, folder, code, **groups):
    """Install the module ``hostile`` with ``code``; groups are {name: attribute} by kind."""
    info = folder / "hostile-1.0.dist-info"
    info.mkdir(parents=True)
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: hostile\nVersion: 1.0\n")
    lines = []
    for kind, names in groups.items():
        lines += [f"[benchnav.{kind}]", *(f"{n} = {place}" for n, place in names.items())]
    (info / "entry_points.txt").write_text("\n".join(lines) + "\n")
    (folder / "hostile.py").write_text(code)
    monkeypatch.syspath_prepend(folder)
