"""A self-signed certificate of this machine, made by openssl at the first start."""

import hashlib
import ipaddress
import os
import subprocess

DAYS = 820  # phones refuse certificates that are valid for more than 825
RENEWED = 7 * 24 * 3600  # [s] before its end


def _subject(name):
    try:
        return 'IP:%s' % ipaddress.ip_address(name)
    except ValueError:
        return 'DNS:%s' % name


def _openssl(*arguments):
    try:
        return subprocess.run(['openssl', *arguments], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False,
                              universal_newlines=True, stdin=subprocess.DEVNULL)
    except FileNotFoundError:
        raise RuntimeError('openssl is not installed: HTTPS needs it (apt-get install openssl)') from None


def own_certificate(folder, names):
    """Files with the certificate and its key, for these addresses and host names. RuntimeError: one line."""
    os.makedirs(folder, mode=0o700, exist_ok=True)
    subjects = ','.join(_subject(name) for name in sorted(set(names)))
    stem = os.path.join(folder, 'certificate_' + hashlib.sha256(subjects.encode()).hexdigest()[:12])
    files = stem + '.pem', stem + '.key'
    if all(map(os.path.exists, files)) and \
            _openssl('x509', '-in', files[0], '-noout', '-checkend', str(RENEWED)).returncode == 0:
        return files
    before = os.umask(0o077)
    try:
        done = _openssl('req', '-x509', '-newkey', 'ec', '-pkeyopt', 'ec_paramgen_curve:prime256v1', '-nodes', '-days',
                        str(DAYS), '-subj', '/CN=mr_hand_interaction', '-addext', 'subjectAltName=' + subjects,
                        '-keyout', files[1], '-out', files[0])
    finally:
        os.umask(before)
    if done.returncode != 0:
        raise RuntimeError('openssl made no certificate: %s' % ' '.join(done.stdout.split())[-200:])
    return files
