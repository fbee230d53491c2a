#!/usr/bin/env python3
"""Checks the documentation: links, headings linked to, pictures, and commands shown in ```console blocks.

A command that begins with `taut`, `build/release/taut` or `./dev` must name a sub-command and options that the program's own help
names, and files of the repository that exist. Without build/release/taut the commands of `taut` are skipped, with a note.
"""

import re
import shlex
import subprocess
import sys
from functools import lru_cache
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
PROGRAM = ROOT / "build/release/taut"

FENCE = re.compile(r"^(```+|~~~+)\s*(\S*)[^\n]*\n(.*?)^\1\s*$", re.MULTILINE | re.DOTALL)
CODE = re.compile(r"(`+)(?!`).*?(?<!`)\1(?!`)", re.DOTALL)
LINK = re.compile(r"!?\[(?:[^\[\]]|\[[^\]]*\])*\]\(\s*<?([^)\s>]+)>?(?:\s+\"[^\"]*\")?\s*\)|<(?:img|a)\s[^>]*?(?:src|href)=\"([^\"]+)\"")


def line_of(text, position):
    return text.count("\n", 0, position) + 1


def blank(match):
    """Text of the same number of lines, so that positions keep their line."""
    return "\n" * match.group().count("\n")


def anchors(page):
    """The identifiers of a page's headings: those given as {#name}, else as mkdocs makes them."""
    text = FENCE.sub(blank, page.read_text(encoding="utf-8"))
    found = set()
    for heading in re.findall(r"^#{1,6}\s+(.+?)\s*#*$", text, re.MULTILINE):
        named = re.search(r"\s*\{:?\s*#([\w-]+)\s*\}$", heading)
        if named:
            found.add(named.group(1))
            continue
        slug = re.sub(r"[^\w\s-]", "", heading.encode("ascii", "ignore").decode()).strip().lower()
        slug = re.sub(r"[-\s]+", "-", slug)
        number, unique = 0, slug
        while unique in found:
            number += 1
            unique = f"{slug}_{number}"
        found.add(unique)
    return found


def check_links(page, text):
    text = CODE.sub(blank, FENCE.sub(blank, text))
    for match in LINK.finditer(text):
        target = match.group(1) or match.group(2)
        if re.match(r"[a-z][a-z+.-]*:", target):
            continue
        path, _, anchor = target.partition("#")
        resolved = (page.parent / path).resolve() if path else page
        if not resolved.exists():
            yield line_of(text, match.start()), f"{target}: there is no such file"
        elif page.is_relative_to(ROOT / "docs") and not resolved.is_relative_to(ROOT / "docs"):
            yield line_of(text, match.start()), f"{target}: a page of the site cannot link out of docs/"
        elif anchor and resolved.suffix == ".md" and anchor not in anchors(resolved):
            yield line_of(text, match.start()), f"{target}: there is no such heading"


@lru_cache(maxsize=None)
def help_of(*command):
    """What `command` prints as its help, or None where it refuses."""
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=30, check=False)
    return done.stdout + done.stderr if done.returncode == 0 else None


def command_lines(block):
    """(line within the block, words) of every command; a `$ ` before it is allowed, what follows | > && ; # is dropped."""
    number = 0
    for logical in re.split(r"(?<!\\)\n", block):
        text = logical.replace("\\\n", " ").strip().removeprefix("$ ")
        try:
            lexer = shlex.shlex(text, posix=True, punctuation_chars="|&;<>")
            lexer.whitespace_split = True
            words = list(lexer)
        except ValueError:
            words = []
        for position, word in enumerate(words):
            if word[0] in "|&;<>":
                words = words[:position]
                break
        yield number, words
        number += logical.count("\n") + 1


def check_words(words):
    """What is wrong with one command, or None."""
    if words[0] == "./dev":
        text, subcommand = help_of(str(ROOT / "dev"), "help"), words[1] if len(words) > 1 else "help"
        if not re.search(rf"^  {re.escape(subcommand)}\b", text or "", re.MULTILINE):
            return f"./dev has no command {subcommand}"
        rest = words[2:] if subcommand != "test" else [word for word in words[2:] if word == "--all"]  # the others are ctest's
        paths = []
    else:
        text, subcommand = help_of(str(PROGRAM), "--help"), None
        rest = words[1:]
        if rest and rest[0].endswith(".nl"):  # as AMPL calls a solver: no command, no option with dashes
            return None if (ROOT / rest[0]).is_file() else f"{rest[0]} is not there"
        if rest and not rest[0].startswith("-"):
            subcommand, rest = rest[0], rest[1:]
            # A help that does not fail shows that the name is accepted, one that mentions it that it is not an argument.
            text = help_of(str(PROGRAM), subcommand, "--help")
            if text is None or not re.search(rf"\b{re.escape(subcommand)}\b", help_of(str(PROGRAM), "--help") or ""):
                return f"taut has no command {subcommand}"
        paths = [word for word in rest if word.startswith(("problems/", "docs/", "tests/"))]
    for word in rest:
        option = word.split("=")[0]
        if re.match(r"--?[a-zA-Z]", word) and not re.search(rf"(?<![\w-]){re.escape(option)}(?![\w-])", text or ""):
            return f"{' '.join(words[:2])} has no option {option}"
    if subcommand == "solve" and rest and re.fullmatch(r"\w+", rest[0]):
        paths.append(f"problems/catalogue/{rest[0]}.json")
    for path in paths:
        if not (ROOT / path).exists():
            return f"{path}: there is no such file"
    return None


def check_commands(text):
    for match in FENCE.finditer(text):
        if match.group(2) != "console":
            continue
        first = line_of(text, match.start(3))
        for number, words in command_lines(match.group(3)):
            if not words or words[0] not in ("taut", "build/release/taut", "./dev"):
                continue
            if words[0] != "./dev" and not PROGRAM.exists():
                yield None, None
                continue
            mistake = check_words(words)
            if mistake:
                yield first + number, mistake


def main():
    pages = sorted({*ROOT.glob("*.md"), *(ROOT / "docs").rglob("*.md")})
    mistakes, skipped = [], 0
    for page in pages:
        text = page.read_text(encoding="utf-8")
        for line, mistake in [*check_links(page, text), *check_commands(text)]:
            if line is None:
                skipped += 1
            else:
                mistakes.append(f"{page.relative_to(ROOT)}:{line}: {mistake}")
    print("\n".join(mistakes) if mistakes else f"docs: links, pictures and commands of {len(pages)} pages are right")
    if skipped:
        print(f"docs: {skipped} commands of taut not checked, {PROGRAM.relative_to(ROOT)} is not built")
    return 1 if mistakes else 0


if __name__ == "__main__":
    sys.exit(main())
