"""The questionnaire in the terminal, on the page by plain requests, and on the page in a browser."""

import os
import re
import signal
import socket
import struct
import subprocess
import tempfile
import unittest
import urllib.error
import urllib.parse
import urllib.request

import paths
import made_up_study
import web_browser
from study import session_folder

LIMIT = 60  # [s], far beyond what a reply needs


class Session(unittest.TestCase):
    def setUp(self):
        holder = tempfile.TemporaryDirectory()
        self.addCleanup(holder.cleanup)
        self.folder = made_up_study.write_session(os.path.join(holder.name, 'session'))
        self.file = os.path.join(self.folder, 'ratings.csv')
        os.remove(self.file)

    def written(self):
        with open(self.file) as file:
            return file.read()

    def write(self, text):
        with open(self.file, 'w') as file:
            file.write(text)

    def start(self, *options):
        program = subprocess.Popen([paths.script('ask_ratings'), self.folder, *options], stdin=subprocess.PIPE,
                                   stdout=subprocess.PIPE, stderr=subprocess.PIPE, universal_newlines=True,
                                   preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL))
        self.addCleanup(self.stop, program)
        return program

    @staticmethod
    def stop(program):
        program.kill()
        program.communicate()

    def answer(self, typed, *options):
        """(status, what was said, what was complained of) for lines typed into the terminal."""
        program = self.start(*options)
        said, complaint = program.communicate(typed, timeout=LIMIT)
        return program.returncode, said, complaint


class Terminal(Session):
    def test_answers_are_added_to_the_sessions_file(self):
        status, said, complaint = self.answer('7\n10\n')
        self.assertEqual((status, complaint), (0, ''))
        self.assertIn('How natural did the sensation', said)
        self.assertIn('0: Extremely inefficient, 10: Extremely efficient', said)
        self.assertEqual(self.written(), 'condition,question,score\nimplicit,naturalness,7\nimplicit,efficiency,10\n')
        self.assertEqual(len(session_folder.read_session(self.folder).ratings), 2)

    def test_bad_answers_are_refused_and_asked_for_again(self):
        status, said, _ = self.answer('11\n-1\n7.5\nten\n\n0\n3\n')
        self.assertEqual((status, said.count('please answer again')), (0, 5))
        self.assertIn("'11' is not a whole number from 0 to 10", said)
        self.assertEqual(self.written(), 'condition,question,score\nimplicit,naturalness,0\nimplicit,efficiency,3\n')

    def test_an_answer_is_kept_when_the_form_is_left_and_only_the_rest_is_asked_later(self):
        status, _, complaint = self.answer('4\n')
        self.assertEqual(status, 1)
        self.assertIn('answers given so far are saved', complaint)
        self.assertEqual(self.written(), 'condition,question,score\nimplicit,naturalness,4\n')
        status, said, _ = self.answer('9\n')
        self.assertEqual(status, 0)
        self.assertNotIn('How natural', said)
        self.assertEqual(self.written(), 'condition,question,score\nimplicit,naturalness,4\nimplicit,efficiency,9\n')

    def test_nothing_is_asked_twice_unless_it_is_wanted(self):
        self.answer('4\n5\n')
        status, said, _ = self.answer('')
        self.assertEqual(status, 0)
        self.assertIn("P01 has answered for 'implicit'", said)
        self.answer('1\n2\n', '--again')
        self.assertTrue(self.written().endswith('naturalness,4\nimplicit,efficiency,5\n'
                                                'implicit,naturalness,1\nimplicit,efficiency,2\n'))

    def test_each_condition_is_asked_about(self):
        made_up_study.write_session(self.folder, trials=[{}, {'condition': 'soft_pad'}])
        self.answer('4\n5\n')
        self.answer('6\n7\n', '--condition', 'soft_pad')
        rows = session_folder.read_session(self.folder).ratings
        self.assertEqual([(row['condition'], row['score']) for row in rows],
                         [('implicit', 4), ('implicit', 5), ('soft_pad', 6), ('soft_pad', 7)])

    def test_a_condition_that_the_session_does_not_have_is_refused(self):
        status, _, complaint = self.answer('4\n5\n', '--condition', 'implict')
        self.assertEqual((status, complaint),
                         (1, "ask_ratings: --condition 'implict': no trial of %s has it; allowed: implicit\n" % self.folder))
        self.assertFalse(os.path.exists(self.file))

    def test_earlier_lines_stay_as_they_are_whatever_their_columns_and_last_line_end(self):
        earlier = 'remark,score,question,condition\n"slow, she said",2,efficiency,seed'
        self.write(earlier)
        self.answer('4\n5\n')
        self.assertEqual(self.written(), earlier + '\n,4,naturalness,implicit\n,5,efficiency,implicit\n')

    def test_a_file_that_cannot_be_read_is_not_written_to(self):
        for text, words in (('condition,question,score\nimplicit,naturalness,12\n', 'line 2: score'),
                            ('condition,question\n', "no column 'score'"),
                            ('condition,question,score\nimplicit,natu', 'line 2 was cut off')):
            with self.subTest(words):
                self.write(text)
                status, _, complaint = self.answer('4\n5\n')
                self.assertEqual((status, complaint.count('\n')), (1, 1))
                self.assertIn(words, complaint)
                self.assertEqual(self.written(), text)

    def test_no_session_is_said_in_one_line(self):
        os.remove(os.path.join(self.folder, 'session.yaml'))
        status, _, complaint = self.answer('4\n5\n')
        self.assertEqual(status, 1)
        self.assertRegex(complaint, r'^ask_ratings: .*session\.yaml: cannot be read: No such file or directory\n$')


class Page(Session):
    def open(self, *options):
        self.program = self.start('--page', *options)
        self.program.stdout.readline()
        self.url = self.program.stdout.readline().strip()
        self.assertRegex(self.url, r'^http://127\.0\.0\.1:\d+/$')

    def assert_done(self):
        said, complaint = self.program.communicate(timeout=LIMIT)
        self.assertEqual((self.program.returncode, complaint), (0, ''))
        self.assertIn('Saved in ' + self.file, said)


class PageByRequests(Page):
    def request(self, data=None, **headers):
        """(status, page); `data` is sent as a form."""
        body = None if data is None else urllib.parse.urlencode(data).encode()
        try:
            with urllib.request.urlopen(urllib.request.Request(self.url, body, headers), timeout=LIMIT) as reply:
                return reply.status, reply.read().decode()
        except urllib.error.HTTPError as error:
            with error:
                return error.code, error.read().decode()

    def token(self):
        return re.search('name="token" value="([^"]+)"', self.request()[1]).group(1)

    def test_answers_are_saved_and_the_server_ends(self):
        self.open()
        status, form = self.request()
        self.assertEqual((status, form.count('type="radio"')), (200, 22))
        self.assertIn('10: Extremely natural', form)
        status, thanks = self.request({'token': self.token(), 'naturalness': 8, 'efficiency': 0})
        self.assertEqual(status, 200)
        self.assertIn('Your answers are saved', thanks)
        self.assert_done()
        self.assertEqual(self.written(), 'condition,question,score\nimplicit,naturalness,8\nimplicit,efficiency,0\n')

    def test_bad_values_are_refused_and_good_ones_stay_chosen(self):
        self.open()
        token = self.token()
        for bad in ('11', '-1', '7.5', '"><script>', ''):
            with self.subTest(bad):
                status, form = self.request({'token': token, 'naturalness': 8, 'efficiency': bad})
                self.assertEqual(status, 400)
                self.assertIn('Efficiency: ', form)
                self.assertIn('id="naturalness_8" value="8" required checked', form)
                self.assertNotIn('<script', form)
                self.assertFalse(os.path.exists(self.file))

    def test_a_form_from_elsewhere_is_refused(self):
        self.open()
        right = {'naturalness': 1, 'efficiency': 1}
        self.assertEqual(self.request(dict(right, token='guessed'))[0], 403)
        self.assertEqual(self.request(right)[0], 403)
        self.assertEqual(self.request(dict(right, token=self.token()), Host='elsewhere.example')[0], 403)
        self.assertEqual(self.request({'token': 'x' * 5000})[0], 413)
        self.assertFalse(os.path.exists(self.file))

    def test_only_this_machine_is_served(self):
        self.open()
        port = urllib.parse.urlsplit(self.url).port
        with open('/proc/net/tcp') as table:
            listening = [line.split()[1] for line in table if line.split()[3] == '0A']
        self.assertIn('0100007F:%04X' % port, listening)
        self.assertNotIn('00000000:%04X' % port, listening)

    def test_an_idle_connection_does_not_keep_others_waiting(self):
        self.open()
        with socket.create_connection(('127.0.0.1', urllib.parse.urlsplit(self.url).port)):
            self.assertEqual(self.request()[0], 200)

    def test_only_what_is_missing_is_asked(self):
        self.write('condition,question,score\nimplicit,naturalness,3\n')
        self.open()
        self.assertEqual(self.request()[1].count('type="radio"'), 11)
        self.assertEqual(self.request({'token': self.token(), 'efficiency': 4})[0], 200)
        self.assert_done()
        self.assertEqual(self.written(), 'condition,question,score\nimplicit,naturalness,3\nimplicit,efficiency,4\n')

    def test_answers_that_cannot_be_saved_are_not_said_to_be(self):
        self.open()
        token = self.token()
        os.mkdir(self.file)
        status, form = self.request({'token': token, 'naturalness': 8, 'efficiency': 9})
        self.assertEqual(status, 500)
        self.assertIn('could not be saved', form)
        os.rmdir(self.file)
        self.assertEqual(self.request({'token': token, 'naturalness': 8, 'efficiency': 9})[0], 200)
        self.assert_done()

    def test_a_browser_that_goes_away_is_no_fault(self):
        self.open()
        url = urllib.parse.urlsplit(self.url)
        for request in ('GET / HTTP/1.1\r\nHost: %s\r\n\r\n' % url.netloc, 'GET / HT',
                        'POST / HTTP/1.1\r\nHost: %s\r\nContent-Length: 9\r\n\r\nab' % url.netloc):
            for _ in range(5):
                gone = socket.create_connection((url.hostname, url.port), timeout=LIMIT)
                gone.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack('ii', 1, 0))  # closing resets it
                gone.sendall(request.encode())
                gone.close()
        self.assertEqual(self.request({'token': self.token(), 'naturalness': 8, 'efficiency': 9})[0], 200)
        self.assert_done()

    def test_interrupted_before_an_answer(self):
        self.open()
        self.program.send_signal(signal.SIGINT)
        _, complaint = self.program.communicate(timeout=LIMIT)
        self.assertEqual(self.program.returncode, 1)
        self.assertIn('ask_ratings: stopped', complaint)
        self.assertFalse(os.path.exists(self.file))


@unittest.skipIf(web_browser.missing(), web_browser.missing())
class PageInABrowser(Page):
    def test_a_participant_answers_by_clicking(self):
        browser = web_browser.Browser()
        self.addCleanup(browser.close)
        self.open()
        browser.open(self.url)
        self.assertEqual(browser.text('h1'), 'Two questions')
        self.assertEqual(browser.run('return document.querySelectorAll("input:checked").length'), 0)
        browser.click('button')  # the browser itself asks for what is missing
        self.assertEqual(browser.text('h1'), 'Two questions')
        browser.click('#naturalness_3')
        browser.click('#naturalness_6')
        browser.click('#efficiency_10')
        self.assertEqual(browser.run('return [...document.querySelectorAll("input:checked")].map(e => e.id)'),
                         ['naturalness_6', 'efficiency_10'])
        self.assertEqual(browser.run('return document.documentElement.scrollWidth > window.innerWidth'), False)
        self.assertFalse(os.path.exists(self.file))
        browser.click('button')
        browser.wait_for_text('h1', 'Thank you')
        self.assert_done()
        self.assertEqual(self.written(), 'condition,question,score\nimplicit,naturalness,6\nimplicit,efficiency,10\n')


if __name__ == '__main__':
    unittest.main()
