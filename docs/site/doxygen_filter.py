#!/usr/bin/python3
"""Prints a header with its comments in the form that Doxygen reads: the INPUT_FILTER of docs/site/Doxyfile.

    doxygen_filter.py HEADER

C++: the words that open a part of a contract, such as "Throws:", become bold and begin a paragraph.
Friends are left out.
C: a comment directly before a declaration, or behind a member, becomes a comment of Doxygen.
"""
import re
import sys

WORDS = r"(Requires|Throws|Thread safety|Complexity|Ownership|Units)"


def filter_cpp(text):
    text = re.sub(r"^ *friend [^({]*;$", "", text, flags=re.MULTILINE)
    text = re.sub(rf"^( *)/// {WORDS}: ", r"\1///\n\1/// **\2:** ", text, flags=re.MULTILINE)
    return re.sub(rf"^( *)(///.*?[.:)]) {WORDS}: ", r"\1\2\n\1///\n\1/// **\3:** ", text, flags=re.MULTILINE)


def filter_c(text):
    head, separator, body = text.partition('extern "C" {\n#endif\n')
    body = re.sub(r"^( *)/\* (?!(?:(?!\*/).)*\*/\n\n)", r"\1/** ", body, flags=re.MULTILINE | re.DOTALL)
    return head + separator + re.sub(r"^( *[^ /*\n].*?)/\* ", r"\1/**< ", body, flags=re.MULTILINE)


def main():
    with open(sys.argv[1], encoding="utf-8") as file:
        text = file.read()
    sys.stdout.write(filter_c(text) if sys.argv[1].endswith(".h") else filter_cpp(text))


if __name__ == "__main__":
    main()
