#!/usr/bin/env python3
"""Checks that every link and image of a finished site leads to a file and to a heading in it: site_links.py FOLDER."""
import html.parser
import pathlib
import sys
import urllib.parse


class Page(html.parser.HTMLParser):
    def __init__(self, path):
        super().__init__()
        self.links, self.places = [], set()
        self.feed(path.read_text(encoding="utf-8"))

    def handle_starttag(self, tag, attributes):
        for name, value in attributes:
            if name in ("id", "name"):
                self.places.add(value)
            elif value and (tag, name) in (("a", "href"), ("img", "src"), ("link", "href"), ("script", "src")):
                self.links.append(value)


folder = pathlib.Path(sys.argv[1]).resolve()
# These repeat the content of all other pages.
pages = {path: Page(path) for path in sorted(folder.glob("**/*.html")) if path.name not in ("print.html", "toc.html")}
wrong, seen = [], 0
for path, page in pages.items():
    for link in page.links:
        parts = urllib.parse.urlsplit(link)
        if parts.scheme or parts.netloc:
            continue
        seen += 1
        target = (path.parent / urllib.parse.unquote(parts.path)).resolve() if parts.path else path
        known = pages.get(target)
        if not target.is_file() or (parts.fragment and known and urllib.parse.unquote(parts.fragment) not in known.places):
            wrong.append(f"{path.relative_to(folder)}: {link}")
for line in sorted(set(wrong)):
    print(line)
print(f"{len(pages)} pages, {seen} links, {len(set(wrong))} of them broken")
sys.exit(bool(wrong) or seen < 100)
