"""Exclusion rules, by docs/formats.md."""
import strict_json
from values import Refused, text

DETAILS = ("name", "label", "type", "id", "parent", "level", "material")
PATTERNS = ("*/bolt*", "a?c", "Ifc*", "", "wand ü", "frame/door", "*", 'a "b"\\c', "[x]", "été\t1")


def _patterns(source):
    if source.random() < 0.5:
        return source.choice(PATTERNS)
    return {key: source.choice(PATTERNS) for key in source.sample(DETAILS, source.randrange(1, 4))}


def make(source):
    """Returns a valid file."""
    rules = {}
    if source.random() < 0.7:
        rules["exclude"] = [{"a": _patterns(source), "b": _patterns(source)} for _ in range(source.randrange(3))]
    if source.random() < 0.5:
        rules["ignored_pairs"] = [[source.choice(PATTERNS), source.choice(PATTERNS)] for _ in range(source.randrange(3))]
    if source.random() < 0.5:
        rules["same_parent"] = source.random() < 0.5
    return strict_json.write(source, rules)


def _words(value):
    if isinstance(value, str):
        return ["name", text(value)]
    found = strict_json.fields(value, DETAILS)
    if not found:
        raise Refused
    return [word for key in DETAILS if key in found for word in (key, text(strict_json.text(found[key])))]


def read(data):
    """Returns the rules."""
    root = strict_json.fields(strict_json.load(data), ("exclude", "ignored_pairs", "same_parent"))
    words = []
    for rule in strict_json.array(root.get("exclude", [])):
        rule = strict_json.fields(rule, "ab", "ab")
        words += ["a", *_words(rule["a"]), "b", *_words(rule["b"])]
    for pair in strict_json.array(root.get("ignored_pairs", [])):
        words += ["pair", *(text(strict_json.text(name)) for name in strict_json.array(pair, 2))]
    same_parent = root.get("same_parent", False)
    if not isinstance(same_parent, bool):
        raise Refused
    return words + ["true" if same_parent else "false"]
