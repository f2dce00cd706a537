#!/usr/bin/env python3
"""Checks that every link of the built guide leads to a file, and to a place in it.

    book_links.py docs/book
"""

import re
import sys
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote


class Page(HTMLParser):
    """The links of a page, and the places to which others can link."""

    def __init__(self, path):
        super().__init__()
        self.links, self.places = [], {""}
        self.feed(path.read_text())

    def handle_starttag(self, tag, attributes):
        values = dict(attributes)
        self.places.add(values.get("id"))
        self.links += [values[name] for name in ("href", "src") if values.get(name)]


def broken(book):
    """Yields each broken link with its page."""
    pages = {path.resolve(): Page(path) for path in book.rglob("*.html")}
    for path, page in pages.items():
        for link in page.links:
            if re.match(r"[a-z]+:", link):
                continue
            file, _, place = unquote(link).partition("#")
            target = (path.parent / file).resolve() if file else path
            is_place = target not in pages or place in pages[target].places
            if not target.exists() or not is_place:
                yield f"{path.relative_to(book.resolve())}: {link}"


def main():
    book = Path(sys.argv[1])
    links = sum(len(Page(path).links) for path in book.rglob("*.html"))
    assert links > 1000, f"only {links} links"
    found = sorted(broken(book))
    print("\n".join(found) if found else f"{links} links lead somewhere")
    sys.exit(bool(found))


main()
