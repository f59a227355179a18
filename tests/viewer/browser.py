"""Pages in a real Chromium without a window: a script runs in the page and reports its result."""

import json
import shutil
import subprocess
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from queue import Empty, Queue
from threading import Thread
from urllib.parse import unquote, urlsplit

import pytest

CHROMIUM = next(filter(None, map(shutil.which, ("chromium", "chromium-browser"))), None)
needs_chromium = pytest.mark.skipif(CHROMIUM is None, reason="no Chromium is installed")
DESKTOP, PHONE = (1280, 800), (390, 844)
TYPES = {"html": "text/html; charset=utf-8", "js": "text/javascript", "css": "text/css"}
_REPORT = """
<script>
window.problems = [];
addEventListener("error", (event) => problems.push(String(event.message)));
addEventListener("unhandledrejection", (event) => problems.push(String(event.reason)));
console.error = (...words) => problems.push(words.join(" "));
const wait = (seconds) => new Promise((done) => setTimeout(done, 1000 * seconds));
async function until(condition) { while (!condition()) await wait(0.02); }
async function report() {
  let result = null;
  try { result = await (async () => { %s })(); } catch (error) { problems.push(String(error)); }
  const requests = performance.getEntriesByType("resource").map((entry) => entry.name);
  await fetch("/report", { method: "POST", body: JSON.stringify({ result, problems, requests }) });
}
addEventListener("load", report);
</script>
"""
NARROWEST = 500  # [pixels] of a window of Chromium; a frame in it may be narrower
_FRAME = """<!doctype html><meta charset="utf-8"><body style="margin: 0">
<iframe src="{}" style="width: {}px; height: {}px; border: 0"></iframe>"""


def in_browser(page, script, folder, size=DESKTOP, limit=60.0):
    """What ``script`` (the body of an async function) returns in a page; no error is allowed.

    The page may ask for nothing: neither from its own host nor from another one.
    """
    result, requests = _visit({"/": page.encode()}.get, "/", script, folder, size, limit)
    assert requests == []
    return result


def in_site(site, path, script, folder, size=DESKTOP, limit=60.0):
    """What ``script`` returns in a page of the folder ``site``; no error is allowed.

    The page may ask for files of the folder alone.
    """
    missing = []

    def read(name):
        file = site / name.lstrip("/")
        if not file.is_file():
            missing.append(name)
            return None
        return file.read_bytes()

    result, requests = _visit(read, f"/{path}", script, folder, size, limit)
    assert missing == []
    assert [name for name in requests if not name.startswith("http://127.0.0.1:")] == []
    return result


def from_disk(path, folder, size=DESKTOP):
    """The document of a page that was opened from disk, after its scripts ran."""
    command = [*_command(folder, size), "--virtual-time-budget=5000", "--dump-dom", path.as_uri()]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60, check=True)
    return done.stdout


def picture(path, folder, size=DESKTOP):
    """A PNG of the page that was opened from disk, after its scripts ran."""
    address = path.as_uri()
    if size[0] < NARROWEST:
        frame = folder / "frame.html"
        frame.write_text(_FRAME.format(address, *size))
        address = frame.as_uri()
    made = folder / "picture.png"
    command = [*_command(folder, size), "--virtual-time-budget=4000", f"--screenshot={made}"]
    subprocess.run([*command, address], capture_output=True, timeout=60, check=True)
    return made


def _visit(read, path, script, folder, size, limit):
    """The result of ``script`` in the page at ``path``, and what the page asked for.

    ``read`` returns the bytes of a path, None where there is no file.
    """
    answers = Queue()

    class Handler(BaseHTTPRequestHandler):
        def do_GET(self):
            name = unquote(urlsplit(self.path).path)
            if name == "/frame-of-a-small-screen":
                content = _FRAME.format(path, *size).encode()
            else:
                content = b"" if name == "/favicon.ico" else read(name)
            if content is not None and name == page:
                injected = _REPORT % script + "<meta charset"
                content = content.replace(b"<meta charset", injected.encode(), 1)
            self.send_response(404 if content is None else 200)
            self.send_header("Content-Type", TYPES.get(name.rpartition(".")[2], TYPES["html"]))
            self.end_headers()
            self.wfile.write(content or b"")

        def do_POST(self):
            answers.put(json.loads(self.rfile.read(int(self.headers["Content-Length"]))))
            self.send_response(204)
            self.end_headers()

        def log_message(self, *_):
            pass

    page = unquote(urlsplit(path).path)
    opened = path if size[0] >= NARROWEST else "/frame-of-a-small-screen"
    with ThreadingHTTPServer(("127.0.0.1", 0), Handler) as server:
        Thread(target=server.serve_forever, daemon=True).start()
        address = f"http://127.0.0.1:{server.server_port}{opened}"
        command = [*_command(folder, size), "--remote-debugging-port=0", address]
        with subprocess.Popen(
            command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
        ) as browser:
            try:
                answer = answers.get(timeout=limit)
            except Empty:
                raise AssertionError(f"the page reported nothing within {limit} s") from None
            finally:
                browser.kill()
                server.shutdown()
    assert answer["problems"] == []
    requests = [name for name in answer["requests"] if not name.endswith("/favicon.ico")]
    return answer.get("result"), requests


def _command(folder, size):
    return [
        CHROMIUM, "--headless=new", "--no-sandbox", "--disable-gpu", "--no-first-run",
        f"--user-data-dir={folder}/profile", f"--window-size={size[0]},{size[1]}",
        "--host-resolver-rules=MAP * ~NOTFOUND, EXCLUDE 127.0.0.1",
    ]  # fmt: skip
