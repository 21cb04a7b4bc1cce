#!/usr/bin/env python3
"""Makes the book of all pages: target/book/html/index.html.

    scripts/book.py [--repository URL] [--mdbook PROGRAM] [--out FOLDER]

The book has the pages of docs/SUMMARY.md, in its order, with the pictures that they show, in the folders where they lie. So links
between pages are the same in the book and on a code host. A link to something else, a source file or a folder, has no page to
lead to: it becomes the path, as code. With --repository, such as https://example.org/me/hwasp/blob/main, it leads there.

mdBook does the rest (`cargo install mdbook`, version 0.5), and scripts/check_links.py looks at what it made.
"""

import argparse
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path
from posixpath import dirname, normpath

from check_links import ELSEWHERE, in_pages, links

ROOT = Path(__file__).resolve().parent.parent
SUMMARY = "docs/SUMMARY.md"


def target(page, link):
    """The path in the repository to which a page's link leads."""
    return normpath(f"{dirname(page)}/{link.partition('#')[0]}".lstrip("/"))


def gathered(page, text, pages, repository):
    """The text of a page with its outward links replaced, and the pictures that it shows."""
    pictures = []
    # From the end, so that what was found before stays where it is.
    for picture, (left, right), (start, end), (first, last) in sorted(links(text), key=lambda link: link[2], reverse=True):
        link = text[start:end]
        if ELSEWHERE.match(link) or link.startswith("#"):
            continue
        path = target(page, link)
        if picture:
            pictures.append(path)
        elif path in pages:
            continue
        elif repository:
            text = f"{text[:start]}{repository.rstrip('/')}/{path}{text[end:]}"
        else:
            said, code = text[left:right], f"`{path}`"
            # A text that is the path, or its end, needs no other words.
            words = code if said.strip("`").rstrip("/") in path else f"{said} ({code})"
            text = f"{text[:first]}{words}{text[last:]}"
    return text, pictures


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--repository", metavar="URL", help="where files lie that are no pages")
    parser.add_argument("--mdbook", metavar="PROGRAM", default="mdbook")
    parser.add_argument("--out", metavar="FOLDER", type=Path, default=ROOT / "target/book", help="[default: target/book]")
    given = parser.parse_args()

    out = given.out.resolve()
    staged, html = out / "pages", out / "html"
    shutil.rmtree(staged, ignore_errors=True)
    summary = (ROOT / SUMMARY).read_text()
    # The same table of contents, seen from the root.
    entries = re.compile(r"\]\(([^)]+)\)")
    pages = {target(SUMMARY, link) for link in entries.findall(summary)}
    left_out = {path.relative_to(ROOT).as_posix() for path in (ROOT / "docs").rglob("*.md")} - pages - {SUMMARY}
    if left_out:
        sys.exit(f"error: docs/SUMMARY.md leaves out {', '.join(sorted(left_out))}")
    files = {"SUMMARY.md": entries.sub(lambda found: f"]({target(SUMMARY, found[1])})", summary)}
    pictures = set()
    for page in pages:
        files[page], shown = gathered(page, (ROOT / page).read_text(), pages, given.repository)
        pictures.update(shown)
    for path, text in files.items():
        (staged / path).parent.mkdir(parents=True, exist_ok=True)
        (staged / path).write_text(text)
    for path in pictures:
        (staged / path).parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(ROOT / path, staged / path)

    if not shutil.which(given.mdbook):
        sys.exit(f"error: there is no program `{given.mdbook}`\nhint: `cargo install mdbook --version 0.5.4` builds it, or name one by --mdbook")
    # mdBook reads a path of its settings from the folder of book.toml, and an absolute one as it is.
    command = [given.mdbook, "build", ROOT / "docs", "--dest-dir", html]
    subprocess.run(command, check=True, env={**os.environ, "MDBOOK_BOOK__SRC": str(staged)})
    faults = list(in_pages(html))
    print("\n".join(faults) if faults else f"{html}/index.html: {len(pages)} pages, every link leads somewhere")
    sys.exit(bool(faults))


if __name__ == "__main__":
    main()
