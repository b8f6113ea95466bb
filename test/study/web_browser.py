"""A headless Chromium, driven by chromedriver over the WebDriver protocol (W3C)."""

import base64
import json
import shutil
import subprocess
import time
import urllib.error
import urllib.request

import paths  # noqa: F401
from free_port import free_port

ELEMENT = 'element-6066-11e4-a52e-4f735466cecf'  # the key of an element's id in the protocol
LIMIT = 180  # [s], far beyond what a reply needs, also of a page that is drawn by software on a busy machine


def missing():
    """What is not installed, or nothing."""
    if not shutil.which('chromedriver'):
        return 'chromedriver is not installed (Debian: chromium-driver)'
    return ''


class Browser:
    def __init__(self, *arguments):
        """`arguments` for Chromium; by default it draws without a GPU."""
        port = free_port()  # not every version tells which it has chosen itself
        self.address = 'http://127.0.0.1:%d' % port
        self.driver = subprocess.Popen(['chromedriver', '--port=%d' % port], stdout=subprocess.DEVNULL,
                                       stderr=subprocess.DEVNULL)
        try:
            self._wait_until_ready()
            options = {'args': ['--headless', '--no-sandbox', '--disable-dev-shm-usage', *(arguments or ['--disable-gpu'])]}
            wanted = {'goog:chromeOptions': options, 'timeouts': {'implicit': 1000 * LIMIT // 2}}  # [ms] to be found
            wanted = {'capabilities': {'alwaysMatch': wanted}}
            self.session = '/session/' + self._send('POST', '/session', wanted)['sessionId']
        except Exception:
            self.close()
            raise

    def _wait_until_ready(self):
        end = time.monotonic() + LIMIT
        while self.driver.poll() is None and time.monotonic() < end:
            try:
                if self._send('GET', '/status')['ready']:
                    return
            except urllib.error.URLError:
                time.sleep(0.05)
        raise RuntimeError('chromedriver did not start')

    def _send(self, method, path, body=None):
        data = json.dumps(body or {}).encode() if method == 'POST' else None
        kind = {'Content-Type': 'application/json'}
        request = urllib.request.Request(self.address + path, data, kind, method=method)
        with urllib.request.urlopen(request, timeout=LIMIT) as reply:
            return json.load(reply)['value']

    def open(self, url):
        self._send('POST', self.session + '/url', {'url': url})

    def find(self, css):
        found = self._send('POST', self.session + '/element', {'using': 'css selector', 'value': css})
        return self.session + '/element/' + found[ELEMENT]

    def click(self, css):
        self._send('POST', self.find(css) + '/click')

    def text(self, css):
        return self._send('GET', self.find(css) + '/text')

    def wait_for_text(self, css, wanted):
        end, seen = time.monotonic() + LIMIT, None
        while seen != wanted:
            if time.monotonic() > end:
                raise AssertionError('%s is %r and not %r' % (css, seen, wanted))
            try:
                seen = self.text(css)
            except urllib.error.HTTPError as error:  # of a page that is just being replaced
                with error:
                    seen = error.reason

    def run(self, script):
        return self._send('POST', self.session + '/execute/sync', {'script': script, 'args': []})

    def run_first(self, script):
        """In every page that is opened from now on, before its own scripts."""
        order = {'cmd': 'Page.addScriptToEvaluateOnNewDocument', 'params': {'source': script}}
        self._send('POST', self.session + '/goog/cdp/execute', order)

    def picture(self):
        """Of what is seen, a PNG."""
        return base64.b64decode(self._send('GET', self.session + '/screenshot'))

    def close(self):
        try:
            if hasattr(self, 'session'):
                self._send('DELETE', self.session)
        finally:
            self.driver.terminate()
            self.driver.wait()
