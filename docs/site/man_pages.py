"""Makes a page for each manual page, by mandoc. Each section is a section of the page, so that the site lists and finds it."""
import re
import subprocess

HEADING = re.compile(r'<section class="S[hs]">\s*<h([12])[^>]*>(?:<a [^>]*>)?(.*?)(?:</a>)?</h[12]>', re.DOTALL)
REST = re.compile(r'</?section[^>]*>|</div>\s*<table class="foot">.*', re.DOTALL)


def fragment(path):
    done = subprocess.run(["mandoc", "-T", "html", "-O", "fragment", str(path)], check=True, capture_output=True, text=True)
    return done.stdout


def page(path):
    program = path.stem
    parts = [f"# {program}(1)\n\n`man {program}` shows this page in a terminal.\n"]
    pieces = HEADING.split(fragment(path))[1:]
    for level, title, body in zip(pieces[::3], pieces[1::3], pieces[2::3]):
        body = REST.sub("", body).strip()
        parts.append(f"#{'#' * int(level)} {' '.join(title.split()).capitalize()}\n")
        if body:
            parts.append(f"~~~{{raw}} html\n<div class=\"manual\">{body}</div>\n~~~\n")
    return "\n".join(parts)


def pages(root):
    for path in sorted(root.glob("docs/*.1")):
        yield f"man/{path.name}.md", page(path)
