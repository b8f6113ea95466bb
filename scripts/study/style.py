"""Common style of figures: colours for colour-blind readers (Okabe & Ito), sizes, output."""

import os
import textwrap

import matplotlib
matplotlib.use('Agg')
import matplotlib.pyplot as plt  # noqa: E402

from .study_data import SIMULATED  # noqa: E402

GROUP_COLOURS = {'beginner': '#E69F00', 'veteran': '#56B4E9'}
DARK = {'beginner': '#8A5A00', 'veteran': '#00527A'}  # the same hues, dark enough for dots and text
FURTHER = (('#009E73', '#005C43'), ('#CC79A7', '#7A3F60'), ('#F0E442', '#6B6400'), ('#D55E00', '#7F3800'))
LETTERS, TITLE_LETTERS = 15, 12  # per inch, of a caption and of a panel's title
PAGE_WIDTH = 9.7  # inches: the report's column, in which text of 9 points stays 9 points
INK, PALE = '#222222', '#BBBBBB'
RAW, FILTERED = '#D55E00', '#0072B2'

# Sizes in points; SVG keeps texts as texts; files do not depend on the time of writing.
plt.rcParams.update({
    'font.size': 9, 'axes.titlesize': 10, 'axes.labelsize': 9, 'xtick.labelsize': 9, 'ytick.labelsize': 8,
    'axes.spines.top': False, 'axes.spines.right': False, 'axes.edgecolor': INK, 'text.color': INK,
    'axes.labelcolor': INK, 'xtick.color': INK, 'ytick.color': INK, 'svg.fonttype': 'none',
    'svg.hashsalt': 'mr_hand_interaction', 'savefig.dpi': 150, 'figure.facecolor': 'white',
})


def colours(groups):
    """{group: (colour, dark one of the same hue)}; groups without a fixed colour take the next ones in a cycle."""
    others = [group for group in groups if group not in GROUP_COLOURS]
    found = {group: (GROUP_COLOURS[group], DARK[group]) for group in groups if group in GROUP_COLOURS}
    found.update((group, FURTHER[i % len(FURTHER)]) for i, group in enumerate(others))
    return found


def new_figure(panels, width, height, **arguments):
    """`panels` panels of a width and height [inches], in as many rows as the page's width needs."""
    columns = max(1, min(panels, int(PAGE_WIDTH // width)))
    rows = -(-panels // columns)
    figure, axes = plt.subplots(rows, columns, figsize=(max(columns * width, 5.2), rows * height + 0.6), squeeze=False,
                                **arguments)
    for empty in axes.flat[panels:]:
        empty.set_visible(False)
    return figure, axes


def panel_title(axes, text):
    """A title that ends where its panel ends."""
    width = axes.figure.get_figwidth() / axes.get_subplotspec().get_gridspec().get_geometry()[1]
    axes.set_title('\n'.join(textwrap.wrap(text, int(TITLE_LETTERS * (width - 0.6)))), loc='left')


def finish(figure, title, caption, source):
    """Title above, caption below; figures of simulated data say so in both."""
    height = figure.get_figheight()
    lines = textwrap.wrap(caption, int(LETTERS * figure.get_figwidth()))
    if source == SIMULATED:
        lines.insert(0, 'SIMULATED OPERATORS: no person took part.')
    title = '\n'.join(textwrap.wrap(title, int(TITLE_LETTERS * figure.get_figwidth())))
    figure.text(0.01, 1 - 0.06 / height, title, ha='left', va='top', fontsize=11, fontweight='bold')
    figure.text(0.01, 0.06 / height, '\n'.join(lines), ha='left', va='bottom', fontsize=7.5, color='#555555')
    figure.tight_layout(rect=(0, (0.1 + 0.14 * len(lines)) / height, 1, 1 - (0.12 + 0.18 * (1 + title.count('\n'))) / height))


def save(figure, folder, name):
    """Writes name.png and name.svg; returns the path of the SVG."""
    os.makedirs(folder, exist_ok=True)
    path = os.path.join(folder, name)
    figure.savefig(path + '.png', metadata={'Software': 'matplotlib'})
    figure.savefig(path + '.svg', metadata={'Date': None})
    plt.close(figure)
    return path + '.svg'
