"""Every command for a user without a home, and for one that no system file names."""

import os
import shutil
import subprocess
import sys

import pytest

from benchnav.kernels import cache_base, kernels_name

CODE = "from benchnav.cli.main import main; main()"
STRANGER = 12345
AS_STRANGER = (
    "setpriv", "--reuid", str(STRANGER), "--regid", str(STRANGER), "--clear-groups",
)  # fmt: skip
HOMES = [{}, {"HOME": "/"}, {"HOME": "/root", "USER": "nobody"}, {"HOME": "/dev/null"}]


def stranger_can_start():
    """Whether this Python can be read, and start workers, as a user that nobody knows."""
    if os.geteuid() != 0 or shutil.which("setpriv") is None:
        return False
    code = "import subprocess as s, sys; s.run([sys.executable, '-c', 'import benchnav'], check=1)"
    start = [*AS_STRANGER, sys.executable, "-c", code]
    tried = subprocess.run(start, check=False, capture_output=True)
    return tried.returncode == 0


def command(*arguments, folder, home, prefix=()):
    """(exit status, stdout, stderr), with temporary files in ``folder``."""
    done = subprocess.run(
        [*prefix, sys.executable, "-c", CODE, *arguments], cwd=folder, capture_output=True,
        text=True, env={"PATH": "/usr/bin:/bin", "TMPDIR": str(folder), **home}, check=False,
    )  # fmt: skip
    assert "Traceback" not in done.stderr
    return done.returncode, done.stdout, done.stderr


def keep_kernels(folder, user):
    """Give the private folder the kernels that are compiled already, which takes a minute."""
    base, name = cache_base().path, kernels_name("benchnav")
    private = folder / f"benchnav-{user}"
    shutil.copytree(base / name, private / ".cache" / "benchnav" / name)
    for path in (private, *private.rglob("*")):
        os.chown(path, user, user)


@pytest.mark.parametrize("home", [{"HOME": "/dev/null"}, {"HOME": "/proc/none"}])
def test_doctor_tells_which_folders_are_used_and_why(home, tmp_path):
    code, stdout, _ = command("doctor", folder=tmp_path, home=home)
    assert code == 0
    private = tmp_path / f"benchnav-{os.geteuid()}"
    for line in ("kernel cache", "receipts"):
        (found,) = [text for text in stdout.splitlines() if line in text]
        assert found.startswith("-")
        assert str(private) in found
        assert f"because {home['HOME']}" in found


def test_doctor_calls_it_wrong_where_nothing_can_be_kept(tmp_path):
    (tmp_path / f"benchnav-{os.geteuid()}").write_text("not a folder")
    code, stdout, _ = command("doctor", folder=tmp_path, home={"HOME": "/dev/null"})
    assert code == 1
    assert "set NUMBA_CACHE_DIR to a folder that you can write" in stdout
    assert "set XDG_STATE_HOME to a folder that you can write" in stdout


def use_every_command(suite, folder, home, prefix=()):
    def call(*arguments):
        return command(*map(str, arguments), folder=folder, home=home, prefix=prefix)

    assert call("doctor")[0] == 0
    for verb in (["list"], ["schema"], ["show", "trap/u"], ["show", "orca"], ["validate", suite]):
        code, _, stderr = call(*verb)
        assert code == 0, stderr
    assert call("new", "navigator", "my-idea")[0] == 0
    for out, more in (("a", ()), ("b", ("--isolate",))):
        code, stdout, stderr = call(
            "run", suite, "--out", out, "--navigator", "orca", "--workers", 1, *more
        )
        assert (code, stdout) == (0, f"{out}\n"), stderr
        assert "failed" not in stderr
    code, stdout, stderr = call("verify", "a", "--workers", 0, "--twin", 0)
    assert code == 0, stdout
    assert "No receipt" not in stderr
    code, table, _ = call("leaderboard", "a")
    assert code == 0
    assert "| yes " in table  # the receipt was found again
    assert call("compare", "a", "orca", "straight-line")[0] == 2
    assert call("pack", "a")[:2] == (0, "a.bnrun\n")
    assert call("merge", "a", "--out", "c")[0] == 0
    code, _, stderr = call("leaderboard", "a", "--curve", "horizon", "--out", "curve.png")
    assert (code, stderr) == (0, "curve.png is drawn\n")


@pytest.mark.long
def test_every_command_works_without_a_home(suite, tmp_path):
    keep_kernels(tmp_path, os.geteuid())
    use_every_command(suite, tmp_path, {"HOME": "/dev/null"})


@pytest.mark.long
@pytest.mark.skipif(not stranger_can_start(), reason="needs root, setpriv and a public Python")
@pytest.mark.parametrize("home", HOMES)
def test_every_command_works_for_a_user_that_no_file_names(suite, tmp_path_factory, home):
    folder = tmp_path_factory.mktemp("stranger")
    shutil.copytree(suite.parent, folder / "suite")
    for path in (folder / "suite", folder, *folder.parents[:2]):
        path.chmod(0o755)
    os.chown(folder, STRANGER, STRANGER)
    keep_kernels(folder, STRANGER)
    use_every_command(folder / "suite" / suite.name, folder, home, AS_STRANGER)
