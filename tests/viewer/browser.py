"""Pages in a real Chromium without a window: a script runs in the page and reports its result."""

import json
import shutil
import subprocess
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from queue import Empty, Queue
from threading import Thread

import pytest

CHROMIUM = next(filter(None, map(shutil.which, ("chromium", "chromium-browser"))), None)
needs_chromium = pytest.mark.skipif(CHROMIUM is None, reason="no Chromium is installed")
DESKTOP, PHONE = (1280, 800), (390, 844)
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
_FRAME = """<!doctype html><meta charset="utf-8"><body style="margin: 0">
<iframe src="/framed" style="width: {}px; height: {}px; border: 0"></iframe>"""


def in_browser(page, script, folder, size=DESKTOP, limit=60.0):
    """What ``script`` (the body of an async function) returns in a page; no error is allowed.

    The page may ask for nothing: neither from its own host nor from another one.
    """
    answers, asked = Queue(), []
    html = page.replace("<meta charset", _REPORT % script + "<meta charset", 1).encode()
    # The window of Chromium is at least 500 pixels wide, but a frame in it is a small screen.
    framed = _FRAME.format(*size).encode() if size[0] < 500 else html
    served = {"/": framed, "/framed": html}

    class Handler(BaseHTTPRequestHandler):
        def do_GET(self):
            asked.append(self.path)
            self.send_response(200 if self.path in served else 404)
            self.send_header("Content-Type", "text/html; charset=utf-8")
            self.end_headers()
            self.wfile.write(served.get(self.path, b""))

        def do_POST(self):
            answers.put(json.loads(self.rfile.read(int(self.headers["Content-Length"]))))
            self.send_response(204)
            self.end_headers()

        def log_message(self, *_):
            pass

    with ThreadingHTTPServer(("127.0.0.1", 0), Handler) as server:
        Thread(target=server.serve_forever, daemon=True).start()
        command = [
            CHROMIUM, "--headless=new", "--no-sandbox", "--disable-gpu", "--no-first-run",
            f"--user-data-dir={folder}/profile", f"--window-size={size[0]},{size[1]}",
            "--host-resolver-rules=MAP * ~NOTFOUND, EXCLUDE 127.0.0.1",
            "--remote-debugging-port=0", f"http://127.0.0.1:{server.server_port}/",
        ]  # fmt: skip
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
    assert set(asked) <= {*served, "/favicon.ico"}, asked
    assert [name for name in answer["requests"] if not name.endswith("/favicon.ico")] == []
    return answer["result"]
