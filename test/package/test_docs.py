#!/usr/bin/env python3
"""The pages: every link leads to a page, a heading or a file that there is, and every page is on a shelf of docs/README.md."""
import glob
import os
import re
import unittest

PACKAGE = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
PAGES = sorted(glob.glob(os.path.join(PACKAGE, "docs", "*.md"))) + [os.path.join(PACKAGE, name)
                                                                    for name in ("README.md", "CONTRIBUTING.md")]
SHELF = os.path.join(PACKAGE, "docs", "README.md")
MAX_README_WORDS = 1500  # more is not read before the first try
MAX_PAGES, MAX_WORDS = 16, 21000  # of docs/: more is not found, and not read. Without measured figures, which are looked up
FIGURE = re.compile(r"<!-- figure \w+/\w+ -->.*?<!-- /figure -->", re.DOTALL)


def text_of(page):
    with open(page, encoding="utf-8") as file:
        return file.read()


def anchors_of(page):
    """Of the headings, as GitHub names them."""
    text = re.sub(r"^```.*?^```", "", text_of(page), flags=re.MULTILINE | re.DOTALL)
    return {re.sub(r"[^\w\- ]", "", heading.strip().lower()).replace(" ", "-")
            for heading in re.findall(r"^#+ (.*)$", text, flags=re.MULTILINE)}


def links_of(page):
    return re.findall(r"\]\(([^)\s]+)\)", text_of(page))


class DocsTest(unittest.TestCase):
    def test_links_lead_somewhere(self):
        wrong = []
        for page in PAGES:
            for link in links_of(page):
                path, _, anchor = link.partition("#")
                target = os.path.normpath(os.path.join(os.path.dirname(page), path)) if path else page
                if not link.startswith(("https://", "http://")) and not (
                        os.path.exists(target) and (not anchor or anchor in anchors_of(target))):
                    wrong.append("%s: %s" % (os.path.relpath(page, PACKAGE), link))
        self.assertEqual(wrong, [])

    def test_pages_that_code_names_are_there(self):
        for folder in ("src", "include", "scripts", "launch", "config", "msg", "srv", "test", "benchmark"):
            for path in glob.glob(os.path.join(PACKAGE, folder, "**", "*"), recursive=True):
                if os.path.isfile(path) and "__pycache__" not in path:
                    with open(path, encoding="utf-8", errors="replace") as file:
                        for name in set(re.findall(r"docs/(\w+\.md)", file.read())) - {"page.md"}:  # of a test
                            self.assertTrue(os.path.exists(os.path.join(PACKAGE, "docs", name)), "%s: %s" % (path, name))

    def test_each_page_is_on_one_shelf(self):
        shelved = [link for link in links_of(SHELF) if re.match(r"\w+\.md$", link)]
        self.assertEqual(sorted(shelved), sorted(os.path.basename(page) for page in PAGES[:-2] if page != SHELF))

    def test_the_readme_is_short(self):
        self.assertLessEqual(len(text_of(PAGES[-2]).split()), MAX_README_WORDS)

    def test_the_pages_are_few_and_short(self):
        pages = [page for page in PAGES[:-2] if page != SHELF]
        self.assertLessEqual(len(pages), MAX_PAGES)
        self.assertLessEqual(sum(len(FIGURE.sub("", text_of(page)).split()) for page in PAGES[:-2]), MAX_WORDS,
                             "say a thing once, and link to it")


if __name__ == "__main__":
    unittest.main()
