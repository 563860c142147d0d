#!/usr/bin/python3
"""Prints a header with its comments in the form that Doxygen reads: the INPUT_FILTER of docs/site/Doxyfile.

    doxygen_filter.py HEADER

C++: the words that open a part of a contract, such as "Throws:", become bold and begin a paragraph.
C: a comment before a declaration, or behind a member, becomes a comment of Doxygen. A comment that an empty line follows
describes the declarations up to the next such comment, which become a group.
"""
import re
import sys

WORDS = r"(Requires|Throws|Thread safety|Complexity|Ownership|Units)"
GROUP = re.compile(r"^/\* ((?:(?!\*/).)*?)\.? ?\*/\n(?=\n)", re.DOTALL | re.MULTILINE)
LONGEST_TITLE = 60


def filter_cpp(text):
    text = re.sub(rf"^( *)/// {WORDS}: ", r"\1///\n\1/// **\2:** ", text, flags=re.MULTILINE)
    return re.sub(rf"^( *///.*?[.:)]) {WORDS}: ", r"\1\n\1///\n\1/// **\2:** ", text, flags=re.MULTILINE)


def group_start(match):
    text = match.group(1)
    title, rest = ("Calls", f" * {text}.\n") if len(text) > LONGEST_TITLE else (text, "")
    return f"/**@}}*/\n/** @name {title}\n{rest} */\n/**@{{*/\n"


def filter_c(text):
    head, separator, body = text.partition('extern "C" {\n#endif\n')
    body = GROUP.sub(group_start, body).replace("/**@}*/\n", "", 1)
    body = re.sub(r"^(\s*)/\* ", r"\1/** ", body, flags=re.MULTILINE)
    body = re.sub(r"(\S.*?)/\* ", r"\1/**< ", body)
    end = body.rfind("#ifdef __cplusplus")
    return head + separator + body[:end] + "/**@}*/\n" + body[end:]


def main():
    with open(sys.argv[1], encoding="utf-8") as file:
        text = file.read()
    sys.stdout.write(filter_c(text) if sys.argv[1].endswith(".h") else filter_cpp(text))


if __name__ == "__main__":
    main()
