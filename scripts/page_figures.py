"""Measured figures and charts of README and docs: results files, the pages that show them, and what makes either stale.

`docs/figures/NAME.json` holds what `scripts/figures --page NAME` measured: the texts of the figures, the revision, the
date, the versions of other engines, and a hash of the sources that the figures depend on. A page shows a figure between
`<!-- figure NAME/KEY -->` and `<!-- /figure -->`. The hash ignores comments and layout, and needs no git. The recipe also draws
charts, `docs/images/CHART.png`; the results file holds their hashes.
"""
import datetime
import hashlib
import json
import os
import re
import subprocess

PACKAGE = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
RESULTS = os.path.join('docs', 'figures')
FIGURE = re.compile(r'(<!-- figure ([a-z_]+)/([a-z0-9_]+) -->\n?)(.*?)(\n?<!-- /figure -->)', re.DOTALL)
CHART = re.compile(r'\]\((?:docs/)?images/(\w+)\.png\)')
PICTURES = ('explain', 'mug', 'web_ar', 'web_view')  # screenshots, which measure nothing
COMMENT = re.compile(r'//[^\n]*|/\*.*?\*/', re.DOTALL)
SOURCES = ('.cpp', '.h', '.py', '.urdf', '.yaml', '.R', '')  # names' ends; '' is a script


def pages():
    """Paths of the pages that may show figures, relative to the package."""
    docs = sorted(name for name in os.listdir(os.path.join(PACKAGE, 'docs')) if name.endswith('.md'))
    return ['README.md'] + [os.path.join('docs', name) for name in docs]


def read(path):
    with open(os.path.join(PACKAGE, path), encoding='utf-8') as file:
        return file.read()


def write(path, text):
    with open(os.path.join(PACKAGE, path), 'w', encoding='utf-8') as file:
        file.write(text)


def hash_of(paths):
    """SHA-256 of the code in files and folders, without comments of C++ and without layout."""
    total = hashlib.sha256()
    for path in sorted(name for given in paths for name in _files(given)):
        text = read(path)
        if path.endswith(('.cpp', '.h')):
            text = COMMENT.sub('', text)
        total.update(('%s\n%s\n' % (path, ' '.join(text.split()))).encode())
    return total.hexdigest()


def _files(path):
    whole = os.path.join(PACKAGE, path)
    if not os.path.isdir(whole):
        return [path]  # one that is gone is an error of open
    return [os.path.relpath(os.path.join(folder, name), PACKAGE) for folder, _, names in os.walk(whole)
            for name in names if os.path.splitext(name)[1] in SOURCES and '__pycache__' not in folder]


def results_path(name):
    return os.path.join(RESULTS, name + '.json')


def load(name):
    return json.loads(read(results_path(name)))


def measured():
    """Names with a results file."""
    return sorted(name[:-5] for name in os.listdir(os.path.join(PACKAGE, RESULTS)) if name.endswith('.json'))


def begin(name, sources):
    """What a results file says of the code and the day; to be taken before measuring."""
    return {'command': 'scripts/figures --page ' + name, 'revision': revision(), 'date': datetime.date.today().isoformat(),
            'sources': {'paths': sources, 'sha256': hash_of(sources)}}


def save(name, begun, figures, engines, charts=()):
    result = dict(begun, engines=engines, charts={chart: hash_of_chart(chart) for chart in charts}, figures=figures)
    write(results_path(name), json.dumps(result, indent=1, ensure_ascii=False) + '\n')


def chart_path(name):
    return os.path.join('docs', 'images', name + '.png')


def hash_of_chart(name):
    """SHA-256 of a chart's file; empty without one."""
    path = os.path.join(PACKAGE, chart_path(name))
    if not os.path.exists(path):
        return ''
    with open(path, 'rb') as file:
        return hashlib.sha256(file.read()).hexdigest()


def revision():
    """The short git revision, with + if files differ from it; unknown outside a repository."""
    try:
        return subprocess.run(['git', '-C', PACKAGE, 'describe', '--always', '--abbrev=8', '--exclude=*', '--dirty=+'],
                              stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, universal_newlines=True,
                              check=True).stdout.strip()
    except (OSError, subprocess.CalledProcessError):
        return 'unknown'


def show(name):
    """Puts the figures of a results file into the pages."""
    figures = load(name)['figures']

    def put(match):
        start, of, key, _, end = match.groups()
        return start + figures[key] + end if of == name and key in figures else match.group(0)
    for page in pages():
        text = read(page)
        if FIGURE.sub(put, text) != text:
            write(page, FIGURE.sub(put, text))


def wrong_pages():
    """A line for each figure that differs from its results file, has none, or is shown nowhere."""
    files, found, shown = {name: load(name)['figures'] for name in measured()}, [], set()
    for page in pages():
        for _, name, key, text, _ in FIGURE.findall(read(page)):
            shown.add((name, key))
            if key not in files.get(name, {}):
                found.append('%s: figure %s/%s has no result; allowed: %s' % (
                    page, name, key, ', '.join(sorted(files.get(name, {}))) or 'none, as %s is missing' % results_path(name)))
            elif text != files[name][key]:
                found.append('%s: figure %s/%s differs from %s: run scripts/figures --show' % (page, name, key, results_path(name)))
    found += ['%s: %s is shown on no page' % (results_path(name), key) for name, figures in files.items()
              for key in figures if (name, key) not in shown]
    return found


def wrong_charts():
    """A line for each chart that differs from the one measured, that no recipe draws, or that no page shows."""
    drawn = {chart: (results_path(name), given) for name in measured() for chart, given in load(name).get('charts', {}).items()}
    shown = {chart for page in pages() for chart in CHART.findall(read(page))} - set(PICTURES)
    found = ['%s: belongs to no results file: let a recipe draw it' % chart_path(chart) for chart in sorted(shown - set(drawn))]
    for chart, (path, given) in sorted(drawn.items()):
        if hash_of_chart(chart) != given:
            found.append('%s: differs from %s: draw it again with scripts/figures --page' % (chart_path(chart), path))
        if chart not in shown:
            found.append('%s: %s is shown on no page' % (path, chart_path(chart)))
    return found


def is_stale(name):
    """True if the code that a results file depends on is neither what it was measured with nor accepted since."""
    result = load(name)
    known = [result['sources']['sha256']] + [note['sha256'] for note in result.get('accepted', [])]
    return hash_of(result['sources']['paths']) not in known


def accept(name, reason, sources):
    """Notes that the code as it is now gives the same figures, and why, after earlier such notes. Measuring again takes them away."""
    result = load(name)
    result['sources']['paths'] = sources
    note = {'because': reason, 'revision': revision(), 'date': datetime.date.today().isoformat(), 'sha256': hash_of(sources)}
    result['accepted'] = result.get('accepted', []) + [note]
    write(results_path(name), json.dumps(result, indent=1, ensure_ascii=False) + '\n')
