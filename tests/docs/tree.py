"""The files of the tree that the documentation tests read, and how pages and comments are taken apart."""

import ast
import io
import pathlib
import re
import tokenize

ROOT = pathlib.Path(__file__).resolve().parents[2]
FOLDERS = ("docs", "include", "pipelines", "python", "samples", "src", "tests")
SCRIPTS = {".cmake", ".sh", ".toml", ".yaml", ".txt", ""}


def files():
    """Every file of the tree but generated ones, relative to its top."""
    found = [path for path in ROOT.iterdir() if path.is_file()]
    for folder in FOLDERS:
        found += [path for path in (ROOT / folder).rglob("*") if path.is_file() and "__pycache__" not in path.parts]
    return sorted(path.relative_to(ROOT) for path in found)


def read(path):
    return (ROOT / path).read_text(encoding="utf-8")


def pages():
    return [path for path in files() if path.suffix == ".md"]


def without_code(text):
    """A page's text without code blocks and code spans; its lines keep their numbers."""
    lines, fence = [], None
    previous_is_text = False
    for line in text.splitlines():
        mark = re.match(r"\s*(```|~~~)", line)
        if fence or mark:
            if mark and fence in (None, mark[1]):
                fence = None if fence else mark[1]
            lines.append("")
            continue
        # Four blanks begin a block of code unless they continue a paragraph or a list.
        indented = line.startswith("    ") and not previous_is_text
        lines.append("" if indented else line)
        previous_is_text = bool(line.strip()) and not indented
    return re.sub(
        r"(`+)(?!`)(.*?)(?<!`)\1(?!`)", lambda match: "\n" * match[0].count("\n"), "\n".join(lines), flags=re.S
    )


def slug(heading):
    """The anchor that a heading gets from GitHub."""
    text = re.sub(r"!?\[([^\]]*)\]\([^)]*\)", r"\1", heading).replace("`", "")
    return re.sub(r"[^\w\- ]", "", text.strip().lower()).replace(" ", "-")


def anchors(text):
    """Every anchor of a page: its headings, numbered where they repeat, and names set by hand."""
    found, seen = set(re.findall(r"<a (?:name|id)=\"([^\"]+)\"", text)), {}
    fence = None
    for line in text.splitlines():
        mark = re.match(r"\s*(```|~~~)", line)
        if mark and fence in (None, mark[1]):
            fence = None if fence else mark[1]
        heading = re.match(r"#{1,6}\s+(.*?)\s*#*$", line)
        if fence or not heading:
            continue
        name = slug(heading[1])
        found.add(f"{name}-{seen[name]}" if name in seen else name)
        seen[name] = seen.get(name, 0) + 1
    return found


def table(text, first_heading):
    """Rows (lists of cells) of the page's table whose first column is headed `first_heading`."""
    rows = []
    for line in text.splitlines():
        cells = [cell.strip() for cell in re.split(r"(?<!\\)\|", line.strip())[1:-1]]
        if rows and not cells:
            return rows[2:]
        if rows or cells[:1] == [first_heading]:
            rows.append(cells)
    return rows[2:]


def python_comments(text):
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        if token.type == tokenize.COMMENT:
            yield token.start[0], token.string
    for node in ast.walk(ast.parse(text)):
        documented = isinstance(node, (ast.Module, ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef))
        if documented and ast.get_docstring(node):
            yield node.body[0].lineno, node.body[0].value.value


def line_comments(text, mark):
    for number, line in enumerate(text.splitlines(), 1):
        if match := re.search(rf"(?:^|\s){mark}.*", line):
            yield number, match[0]


def comments(path):
    """(line number, text) of each comment of a source file; of a page, of each line."""
    if path.suffix == ".md":
        return list(enumerate(read(path).splitlines(), 1))
    if path.suffix == ".py":
        return list(python_comments(read(path)))
    if path.suffix in (".h", ".cpp"):
        return list(line_comments(read(path), "//"))
    if path.suffix in SCRIPTS:
        text = read(path)
        is_python = text.startswith("#!") and "python" in text.splitlines()[0]
        return list(python_comments(text) if is_python else line_comments(text, "#"))
    return []
