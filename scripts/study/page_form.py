"""The questions on a page that is served to this machine only."""

import collections
import html
import http.server
import secrets
import socketserver
import sys
import threading
import urllib.parse

from . import program
from .questions import ALL, score_of
from .session_folder import StudyError

LOCALHOST = '127.0.0.1'
LONGEST = 4096  # bytes of a form
STYLE = '''body{font:18px/1.5 sans-serif;color:#222;background:#fff;max-width:46rem;margin:2rem auto;padding:0 1rem}
fieldset{border:1px solid #bbb;border-radius:.5rem;margin:0 0 1.5rem;padding:1rem}
legend{font-weight:bold;padding:0 .4rem}.scale{display:flex;justify-content:space-between}
.scale label{flex:1;text-align:center;padding:.6rem 0;cursor:pointer;border-radius:.3rem}
.scale label:hover{background:#e8f1f8}.scale input{display:block;width:1.4rem;height:1.4rem;margin:0 auto .3rem}
.ends{display:flex;justify-content:space-between;color:#555;font-size:.85rem}
button{font:inherit;padding:.6rem 2rem;background:#00527a;color:#fff;border:0;border-radius:.4rem;cursor:pointer}
.wrong{color:#a00000;font-weight:bold}'''
PAGE = '''<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width">
<title>{title}</title><style>{style}</style></head><body>
<h1>{title}</h1>
{body}
</body></html>
'''


class Form(socketserver.ThreadingMixIn, http.server.HTTPServer):
    """Serves the form until it is answered. `questions` are those to be asked."""
    daemon_threads = True

    def __init__(self, answers, questions):
        super().__init__((LOCALHOST, 0), _Handler)
        self.answers, self.questions = answers, questions
        self.token = secrets.token_urlsafe(16)  # which a page from elsewhere does not know
        self.lock, self.saved, self.error = threading.Lock(), False, None

    @property
    def url(self):
        return 'http://%s:%d/' % (LOCALHOST, self.server_port)

    def handle_error(self, *_):
        """Ignores the error if a browser has gone."""
        error = sys.exc_info()[1]
        if not isinstance(error, OSError):
            print('%s: %s' % (program.name(), program.line_of(error)), file=sys.stderr)

    def submit(self, fields):
        """(status, page) for a form that was sent. A form sent twice is saved once."""
        chosen, wrong = _checked(self.questions, fields)
        with self.lock:
            if not secrets.compare_digest(fields.get('token', '').encode(), self.token.encode()):
                return 403, page('Not saved', '<p class="wrong">This form is not the one that was asked for. '
                                              '<a href="/">Open it anew.</a></p>')
            if wrong:
                return 400, self.form(chosen, wrong)
            if not self.saved:
                try:
                    self.answers.add(chosen)
                except (OSError, StudyError) as error:
                    self.error = error
                    return 500, self.form(chosen, 'The answers could not be saved: %s' % error)
                self.saved, self.error = True, None
        return 200, page('Thank you', '<p>Your answers are saved. You can close this page.</p>')

    def form(self, chosen, wrong=''):
        fields = ''.join(_fieldset(question, chosen.get(question)) for question in self.questions)
        problem = '<p class="wrong" role="alert">%s</p>' % html.escape(wrong) if wrong else ''
        return page({1: 'A question', 2: 'Two questions'}.get(len(self.questions), 'Questions'),
                    '<form method="post" action="/">%s<input type="hidden" name="token" value="%s">%s'
                    '<button type="submit">Save</button></form>' % (problem, self.token, fields))


def serve(form):
    """Returns when the answers are saved; KeyboardInterrupt ends it before."""
    try:
        form.serve_forever(poll_interval=0.05)
    finally:
        form.server_close()


def page(title, body):
    return PAGE.format(title=title, style=STYLE, body=body)


def _checked(questions, fields):
    """The valid scores, and a sentence about the others."""
    chosen, wrong = collections.OrderedDict(), ''
    for question in questions:
        try:
            chosen[question] = score_of(question, fields.get(question, ''))
        except ValueError as error:
            said = str(error) if fields.get(question) else 'please choose a number from %d to %d' % (
                ALL[question].lowest, ALL[question].highest)
            wrong = wrong or '%s: %s.' % (question.capitalize(), said)
    return chosen, wrong


def _fieldset(question, chosen):
    asked = ALL[question]
    choices = ''.join(
        '<label><input type="radio" name="%s" id="%s_%d" value="%d" required%s>%d</label>'
        % (question, question, value, value, ' checked' if value == chosen else '', value)
        for value in range(asked.lowest, asked.highest + 1))
    return ('<fieldset><legend>%s</legend><div class="scale">%s</div><div class="ends"><span>%d: %s</span>'
            '<span>%d: %s</span></div></fieldset>' % (html.escape(asked.text), choices, asked.lowest, asked.low,
                                                      asked.highest, asked.high))


class _Handler(http.server.BaseHTTPRequestHandler):
    timeout = 10  # [s] for a request to arrive

    def do_GET(self):
        if self.path != '/':
            self._reply(404, page('Not here', '<p><a href="/">The questions are here.</a></p>'))
        elif self._is_ours():
            self._reply(200, self.server.form({}))

    def do_POST(self):
        if not self._is_ours():
            return
        try:
            length = int(self.headers.get('Content-Length', ''))
        except ValueError:
            length = -1
        if not 0 <= length <= LONGEST:
            self._reply(413, page('Not saved', '<p>That is no answer to the questions.</p>'))
            return
        text = self.rfile.read(length).decode('utf-8', 'replace')
        fields = {name: values[-1] for name, values in urllib.parse.parse_qs(text).items()}
        try:
            self._reply(*self.server.submit(fields))
        finally:
            if self.server.saved:  # whether or not the browser waits for the answer
                threading.Thread(target=self.server.shutdown).start()

    def _is_ours(self):
        """Refuses requests under a foreign host name that leads to this machine."""
        ours = self.headers.get('Host') in ('%s:%d' % (name, self.server.server_port) for name in
                                            (LOCALHOST, 'localhost'))
        if not ours:
            self._reply(403, page('Not here', '<p>Open %s</p>' % self.server.url))
        return ours

    def _reply(self, status, text):
        data = text.encode('utf-8')
        self.send_response(status)
        for name, value in (('Content-Type', 'text/html; charset=utf-8'), ('Content-Length', str(len(data))),
                            ('Cache-Control', 'no-store'), ('Connection', 'close'),
                            ('Content-Security-Policy', "default-src 'none'; style-src 'unsafe-inline'; "
                                                        "form-action 'self'; frame-ancestors 'none'")):
            self.send_header(name, value)
        self.end_headers()
        self.close_connection = True
        self.wfile.write(data)

    def log_message(self, *_):
        pass
