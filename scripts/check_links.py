#!/usr/bin/env python3
"""Looks for links that lead nowhere.

    scripts/check_links.py           in all Markdown files of the repository
    scripts/check_links.py FOLDER    in all HTML pages of a folder, of the built book for one

A relative link has to lead to a file that is there (in the repository: that Git knows), and what stands behind its # to a heading
or an id of that page. Links to the network are left alone. Prints what it finds; exit status 1 if that is anything.
"""

import re
import subprocess
import sys
from html.parser import HTMLParser
from pathlib import Path
from posixpath import dirname, normpath
from urllib.parse import unquote

FENCED = re.compile(r"^ *(```+|~~~+).*?^ *\1 *$", re.M | re.S)
# Code within a line, too: what stands there is no link.
CODE = re.compile(FENCED.pattern + r"|(?<!`)(`+)(?!`).+?(?<!`)\2(?!`)", re.M | re.S)
# [text](target) and ![text](target); the text may hold brackets.
LINK = re.compile(r"(!?)\[((?:[^\[\]]|\[[^\[\]]*\])*)\]\(([^)\s]+)\)")
HEADING = re.compile(r"^ {0,3}#{1,6} +(.+?)(?: +#+)? *$", re.M)
ELSEWHERE = re.compile(r"[a-z][a-z0-9+.-]*:|//", re.I)


def without_code(text):
    """The text with blanks in place of code, each character where it was."""
    return CODE.sub(lambda found: re.sub(r"[^\n]", " ", found.group()), text)


def links(text):
    """All links outside of code: whether it is a picture, and the spans of its text, its target and the whole."""
    for found in LINK.finditer(without_code(text)):
        yield found.group(1) == "!", found.span(2), found.span(3), found.span()


def anchors(text):
    """What may stand behind the # of a link to a Markdown file, as code hosts and mdBook make it of headings."""
    found, seen = set(), {}
    for heading in HEADING.findall(FENCED.sub("", text)):
        plain = LINK.sub(r"\2", heading)
        slug = re.sub(r"[^\w\- ]", "", plain.lower()).replace(" ", "-")
        count = seen.get(slug, 0)
        seen[slug] = count + 1
        found.add(f"{slug}-{count}" if count else slug)
    return found


def in_repository(root):
    """The faults of all Markdown files that Git knows or has not been told to ignore."""
    listed = subprocess.run(["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"], cwd=root, check=True, capture_output=True)
    files = {name for name in listed.stdout.decode().split("\0") if name and (root / name).is_file()}
    folders = {str(parent) for name in files for parent in Path(name).parents}
    texts = {name: (root / name).read_text() for name in files if name.endswith(".md")}
    known = {name: anchors(text) for name, text in texts.items()}
    for name, text in sorted(texts.items()):
        for _, _, (start, end), _ in links(text):
            target = text[start:end]
            if ELSEWHERE.match(target):
                continue
            path, _, anchor = unquote(target).partition("#")
            whole = normpath(f"{dirname(name)}/{path}".lstrip("/")) if path else name
            line = text.count("\n", 0, start) + 1
            if whole not in files and whole not in folders:
                yield f"{name}:{line}: {target} is not there"
            elif anchor and whole in known and anchor not in known[whole]:
                yield f"{name}:{line}: {target}: {whole} has no such heading"


class Page(HTMLParser):
    """Ids of a page, and where it leads."""

    def __init__(self, text):
        super().__init__(convert_charrefs=True)
        self.ids, self.targets = set(), []
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        given = dict(attributes)
        self.ids |= {given[name] for name in ("id", "name") if given.get(name)}
        for name in ("href", "src"):
            if given.get(name) and not ELSEWHERE.match(given[name]):
                self.targets.append((self.getpos()[0], given[name]))


def in_pages(folder):
    """The faults of all HTML pages of a folder."""
    pages = {path.relative_to(folder).as_posix(): Page(path.read_text()) for path in sorted(folder.rglob("*.html"))}
    for name, page in pages.items():
        # It is shown in place of any page, whose depth it cannot know.
        if name == "404.html":
            continue
        for line, target in page.targets:
            path, _, anchor = unquote(target).partition("#")
            whole = normpath(f"{dirname(name)}/{path.partition('?')[0]}".lstrip("/")) if path else name
            if not (folder / whole).is_file():
                yield f"{name}:{line}: {target} is not there"
            elif anchor and whole in pages and anchor not in pages[whole].ids:
                yield f"{name}:{line}: {target}: {whole} has no such id"
    if not pages:
        yield f"{folder} has no pages"


def main():
    if len(sys.argv) > 2 or sys.argv[1:] == ["--help"]:
        sys.exit(__doc__.strip())
    faults = list(in_pages(Path(sys.argv[1])) if sys.argv[1:] else in_repository(Path(__file__).resolve().parent.parent))
    print("\n".join(faults) if faults else "every link leads somewhere")
    sys.exit(bool(faults))


if __name__ == "__main__":
    main()
