"""Common parts of the scripts for users: every error ends a script with at most one line that names the cause, never with a
traceback. Import this before slow modules, so that Ctrl-C during their import is handled too."""

import argparse
import errno
import io
import os
import signal
import socket
import stat
import sys
import threading
import traceback
import urllib.parse

INTERRUPTED = 128 + signal.SIGINT  # a shell's status for a program that Ctrl-C has ended
READER_GONE = 128 + signal.SIGPIPE
PATIENCE = 5.0  # s; limit for an answer of the master
MEBIBYTE = 1 << 20
BEGINNING, END = 300, 200  # characters shown of a longer line
TRIED = 'MR_HAND_PYTHONS_TRIED'  # Pythons that have started this script, by their paths
_tried = os.environ.pop(TRIED, '').split(os.pathsep)
if not hasattr(threading.Thread, 'isAlive'):  # Debian 11's rospy calls it as it ends; its Python has it no more
    threading.Thread.isAlive = threading.Thread.is_alive


class OneLineParser(argparse.ArgumentParser):
    """Reports bad usage in one line."""

    def error(self, message):
        self.exit(2, '%s: %s; --help shows the usage\n' % (self.prog, one_line(message)))


def new_file(path):
    """Type of an argument: a path that is free."""
    if os.path.lexists(path):
        raise argparse.ArgumentTypeError("'%s' is there already; allowed: a file that is not" % one_line(path))
    return path


def name():
    return os.path.splitext(os.path.basename(sys.argv[0]))[0]


def run(main, at_once=False):
    """Calls `main`, and exits with the status that it returns; None is 0. `at_once`: does not wait for threads of ROS."""
    _print_what_cannot_be_encoded()
    try:
        code, line = main(), ''
    except BaseException as error:  # SystemExit and KeyboardInterrupt too
        code, line = _end_of(error)
    code = _tell(code or 0, line)
    if at_once:
        _leave(code)
    sys.exit(code)


def _print_what_cannot_be_encoded():
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors='backslashreplace')


def _end_of(error):
    """Exit status and message of an exception."""
    if isinstance(error, KeyboardInterrupt):
        _leave(INTERRUPTED)
    if isinstance(error, SystemExit):
        return (1, error.code) if isinstance(error.code, str) else (error.code, '')
    if isinstance(error, BrokenPipeError):
        return READER_GONE, ''
    if isinstance(error, ImportError):
        return 1, missing(error)
    return 1, '%s: %s' % (name(), line_of(error))


def _tell(code, line):
    """Prints the message; returns the status, which changes if the output cannot be written."""
    try:
        if sys.stdout is not None:
            sys.stdout.flush()
    except BrokenPipeError:
        code = READER_GONE
        _silence()
    except OSError as error:
        code, line = code or 1, line or '%s: standard output: %s' % (name(), error.strerror)
        _silence()
    if line:
        print(line, file=sys.stderr)
    return code


def line_of(error):
    """One line for an uncaught exception."""
    if isinstance(error, OSError) and error.filename is not None:
        return '%s: %s' % (error.filename, error.strerror)
    if isinstance(error, OSError):
        return error.strerror or str(error)
    if isinstance(error, MemoryError):
        return 'there is not enough memory for it'
    if isinstance(error, RecursionError):
        return 'something is nested too deep'
    place = traceback.extract_tb(error.__traceback__)[-1:]
    where = ' (%s, line %d)' % (os.path.basename(place[0].filename), place[0].lineno) if place else ''
    return 'a fault of this program, please report it: %s: %s%s' % (type(error).__name__, one_line(str(error)), where)


def one_line(text):
    """The text as one line without control characters; a long one is shortened in the middle."""
    text = ''.join(letter if letter.isprintable() else '?' for letter in text)
    return text if len(text) <= BEGINNING + END else text[:BEGINNING] + ' ... ' + text[-END:]


def _silence():
    """Prevents Python from flushing the output again at its exit."""
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, 1)
    os.close(nowhere)


def _leave(code):
    for stream in (sys.stdout, sys.stderr):
        try:
            if stream is not None:
                stream.flush()
        except OSError:
            pass
    os._exit(code)


def _hook(kind, error, _):
    if issubclass(kind, KeyboardInterrupt):
        _leave(INTERRUPTED)
    print('%s: %s' % (name(), line_of(error)), file=sys.stderr)


sys.excepthook = _hook


def missing(error, remedy='build, then source devel/setup.bash'):
    """Message for an ImportError. First restarts the script with each Python that may have the module: with pyenv or conda, the
    first Python on PATH, or that in /usr/bin, may not be the one of ROS."""
    if sys.argv[0] and os.path.isfile(sys.argv[0]):
        for python in (os.path.join(os.environ.get('CONDA_PREFIX') or '/usr', 'bin', 'python3'), '/usr/bin/python3'):
            if python not in _tried and os.access(python, os.X_OK):
                os.environ[TRIED] = os.pathsep.join(_tried + [python])
                os.execv(python, [python] + sys.argv)
    return '%s: %s in %s; %s' % (name(), one_line(str(error)), sys.executable, remedy)


def find_built_modules():
    """Finds the modules of this package's devel space if no workspace has been sourced."""
    package = os.path.abspath(os.path.join(os.path.dirname(os.path.abspath(__file__)), '..', '..'))
    modules = os.path.join(package, 'devel', 'lib', 'python3', 'dist-packages')
    if os.path.isdir(modules):
        sys.path.append(modules)
    if os.path.exists(os.path.join(package, 'package.xml')):
        os.environ.setdefault('ROS_PACKAGE_PATH', package + os.pathsep + '/usr/share')


def read_text(path, most=64 * MEBIBYTE, encoding='utf-8'):
    """Text of a regular file. Raises OSError or UnicodeDecodeError."""
    with open_regular(path, most) as file:
        return file.read().decode(encoding)


def open_regular(path, most=None):
    """open(path, 'rb') for a regular file of limited size. Raises OSError that says what else it is."""
    descriptor = os.open(path, os.O_RDONLY | os.O_NONBLOCK | os.O_CLOEXEC)
    try:
        found = os.fstat(descriptor)
        if not stat.S_ISREG(found.st_mode):
            raise OSError(errno.EINVAL, 'is %s; allowed: a file' % _kind(found.st_mode), path)
        if most is not None and found.st_size > most:
            raise OSError(errno.EFBIG, 'has %d bytes; allowed: at most %d' % (found.st_size, most), path)
        return os.fdopen(descriptor, 'rb')
    except OSError:
        os.close(descriptor)
        raise


def _kind(mode):
    return 'a folder' if stat.S_ISDIR(mode) else 'a pipe' if stat.S_ISFIFO(mode) else 'a device or a socket'


def why_no_master():
    """One line, or None if there is a master."""
    import rosgraph
    uri = rosgraph.get_master_uri()
    try:
        parts = urllib.parse.urlsplit(uri)
        fine = parts.scheme == 'http' and bool(parts.hostname) and parts.port != 0
    except ValueError:
        fine = False
    if not fine:
        return "ROS_MASTER_URI '%s' is no address of a master; allowed: http://HOST:PORT" % uri
    before = socket.getdefaulttimeout()
    socket.setdefaulttimeout(PATIENCE)
    try:
        online = bool(rosgraph.Master('/' + name()).getPid())
    except Exception:  # from another kind of server; rosgraph's is_master_online would also catch Ctrl-C
        online = False
    finally:
        socket.setdefaulttimeout(before)
    return None if online else '%s does not answer: start a launch file or roscore, or set ROS_MASTER_URI' % uri
