"""Checks pages that `hwasp report` made, as far as that goes without a browser: python3 scripts/report_page.py PAGE...

Elements are closed in the order in which they were opened, ids are unique, links lead to one of them or to a file that is there,
headings skip no level, pictures have names, tables have captions and heads, nothing is loaded, and a page is no larger than 500 kB. In a browser
scripts/report_check.mjs looks at the rest.
"""

import sys
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote

MOST_BYTES = 500_000
VOID = {"meta", "br", "input", "link", "img", "hr"}
# What would be fetched, or would make a part of the page do something.
LOADING = {"src", "srcset", "data", "action", "formaction", "poster", "background", "style", "ping"}


class Page(HTMLParser):
    def __init__(self):
        super().__init__(convert_charrefs=True)
        self.faults, self.open, self.ids, self.links, self.level = [], [], set(), [], 0
        self.tables, self.files = [], []

    def fault(self, text):
        self.faults.append(f"line {self.getpos()[0]}: {text}")

    def handle_starttag(self, tag, attributes):
        if tag not in VOID:
            self.open.append(tag)
        self.look(tag, dict(attributes))

    def handle_startendtag(self, tag, attributes):
        self.look(tag, dict(attributes))

    def look(self, tag, given):
        if tag in {"link", "img", "iframe", "object", "embed", "base", "image", "use"}:
            self.fault(f"<{tag}> may load something")
        for name, value in given.items():
            if name in LOADING or name.startswith("on"):
                self.fault(f"<{tag} {name}>")
            if "href" in name and (value or "").startswith("#"):
                self.links.append(value[1:])
            elif "href" in name:
                self.files.append(value or "")
        name = given.get("id")
        if name is not None:
            if name in self.ids:
                self.fault(f"two elements are called {name!r}")
            self.ids.add(name)
        if tag in {"h1", "h2", "h3", "h4"}:
            level = int(tag[1])
            if level > self.level + 1:
                self.fault(f"<{tag}> follows a heading of level {self.level}")
            self.level = level
        if tag == "svg" and "aria-hidden" not in given and not (given.get("role") == "img" and "aria-labelledby" in given):
            self.fault("a picture without a name")
        if tag == "table":
            self.tables.append(set())
        elif self.tables:
            self.tables[-1].add(tag)
        if tag == "th" and "scope" not in given:
            self.fault("a head of a table without a scope")

    def handle_endtag(self, tag):
        if not self.open or self.open.pop() != tag:
            self.fault(f"</{tag}> closes what was not opened last")
        if tag == "table" and not {"caption", "th"} <= self.tables.pop():
            self.fault("a table without a caption or without heads")


def check(path):
    data = path.read_bytes()
    page = Page()
    page.feed(data.decode())
    page.close()
    if page.open:
        page.fault(f"never closed: {page.open}")
    page.faults += [f"no element is called {link!r}" for link in page.links if link not in page.ids]
    for link in page.files:
        file = path.parent / unquote(link)
        if ":" in link or link.startswith("/") or not file.is_file():
            page.faults.append(f"{link!r} leads to no file beside the page")
    if len(data) > MOST_BYTES:
        page.faults.append(f"{len(data)} bytes are more than {MOST_BYTES}")
    if b"@import" in data or b"url(" in data:
        page.faults.append("the style loads something")
    return len(data), page.faults


def main():
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    failed = False
    for path in map(Path, sys.argv[1:]):
        size, faults = check(path)
        for fault in faults:
            print(f"{path}: {fault}", file=sys.stderr)
        failed |= bool(faults)
        print(f"{path}: {size} bytes, {len(faults)} faults")
    sys.exit(failed)


main()
