"""The editable install; all else stands in pyproject.toml."""

from base64 import urlsafe_b64encode
from hashlib import sha256
from pathlib import Path
from zipfile import ZIP_DEFLATED, ZipFile

from setuptools import setup
from setuptools.command.editable_wheel import editable_wheel

# Finders that the line installs go to the front: their count among those before is 0.
FIRST = "import sys; before = list(sys.meta_path); {line}; sys.meta_path.sort(key=before.count)\n"


class EditableWheel(editable_wheel):
    """An editable install that is found before the folders on the path.

    setuptools adds its finder behind Python's own, which takes a folder that holds a clone
    called benchnav for a namespace package.
    """

    def run(self) -> None:
        """Build the wheel, and rewrite the line that installs the finder."""
        super().run()
        (wheel,) = Path(self.dist_dir).glob("*.whl")
        with ZipFile(wheel) as archive:
            files = {name: archive.read(name) for name in archive.namelist()}
        (pth,) = (name for name in files if name.endswith(".pth"))
        (record,) = (name for name in files if name.endswith(".dist-info/RECORD"))
        old = _recorded(pth, files[pth])
        files[pth] = FIRST.format(line=files[pth].decode().strip()).encode()
        files[record] = files[record].replace(old, _recorded(pth, files[pth]))
        with ZipFile(wheel, "w", ZIP_DEFLATED) as archive:
            for name, content in files.items():
                archive.writestr(name, content)


def _recorded(name: str, content: bytes) -> bytes:
    """Return the line of RECORD for a file."""
    digest = urlsafe_b64encode(sha256(content).digest()).decode().rstrip("=")
    return f"{name},sha256={digest},{len(content)}".encode()


setup(cmdclass={"editable_wheel": EditableWheel})
