"""Parses a page as a browser does, by the rules of HTML 5, and names every error in it."""

import sys

import html5lib

parser = html5lib.HTMLParser()
with open(sys.argv[1], "rb") as page:
    parser.parse(page)
for (line, column), name, values in parser.errors:
    print(f"{sys.argv[1]}:{line}:{column}: {name} {values}")
sys.exit(1 if parser.errors else 0)
