#!/usr/bin/env python3
"""Plants faults in a small tree with a table of promises. tools/promises.py must report each of them, and accept the tree without faults."""
import contextlib
import io
import pathlib
import sys
import tempfile
import unittest
from unittest import mock

sys.path.insert(0, str(pathlib.Path(__file__).parents[2] / "tools"))
import promises

PAGE = """# Promises

| promise | said in | held by |
|---|---|---|
| Boxes touch. | [design](design.md#steps) | `Boxes.Touch`, `BoxesOf.Each`, `BoxesIn.Both`, `BoxRules.hold` |
| Ranks agree. | [design](design.md) | `Ranks.detect`, `Ranks.serve`, `docs.page_design`, `fuzz_npy` |
| Python agrees. | [design](design.md) | `test_pairs.py::test_equal`, `test_pairs.py::Pairs.test_bytes`, `page.mjs::a click selects` |

| promise | said in | reason |
|---|---|---|
| It is fast. | [design](design.md) | Times depend on the machine. |
"""
CASES = """// Tests.
TEST(Boxes, Touch) {}
// TEST(Boxes, InAComment) {}
TEST_P(BoxesOf, Each) {}
INSTANTIATE_TEST_SUITE_P(All, BoxesOf, Values(1));
TYPED_TEST_SUITE(BoxesIn, Both);
TYPED_TEST(BoxesIn, Both) {}
RC_GTEST_PROP(BoxRules, hold, ()) {}
"""
LISTS = """function(add_page name)
    add_test(NAME docs.${name} COMMAND run)
endfunction()
octopair_test(boxes_test boxes_test.cpp)
set(scripts detect)
if(TARGET server)
    list(APPEND scripts serve)  # serve, not bake
endif()
foreach(script IN LISTS scripts)
    add_test(NAME Ranks.${script} COMMAND "${script}.sh" $<TARGET_FILE:program>)
endforeach()
file(GLOB pages RELATIVE ${PROJECT_SOURCE_DIR}/docs ${PROJECT_SOURCE_DIR}/docs/d*.md)
foreach(page ${pages})
    get_filename_component(name ${page} NAME_WE)
    add_page(page_${name})
endforeach()
function(add_fuzzer name)
    add_test(NAME ${name} COMMAND ${name})
endfunction()
add_fuzzer(fuzz_npy)
"""
TREE = {
    "docs/promises.md": PAGE, "docs/design.md": "# Design\n", "tests/CMakeLists.txt": LISTS, "tests/boxes_test.cpp": CASES,
    "tests/test_pairs.py": "def test_equal():\n    pass\n\n\nclass Pairs:\n    def test_bytes(self):\n        pass\n",
    "tests/page.mjs": "test('a click selects', async () => {});\n",
}
# File, the right text, the wrong text, and what the message must have.
FAULTS = [
    ("docs/promises.md", "`Boxes.Touch`", "`Boxes.Tuch`", ":5: no test Boxes.Tuch"),
    ("docs/promises.md", "`Boxes.Touch`", "`Boxes.InAComment`", ":5: no test Boxes.InAComment"),
    ("docs/promises.md", "`Ranks.detect`", "`Ranks.bake`", ":6: no test Ranks.bake"),
    ("docs/promises.md", "`test_pairs.py::test_equal`", "`test_pairs.py::equal`", ":7: no test test_pairs.py::equal"),
    ("docs/promises.md", "`page.mjs::a click selects`", "`page.mjs::a click`", ":7: no test page.mjs::a click"),
    ("docs/promises.md", "`Ranks.detect`, `Ranks.serve`, `docs.page_design`, `fuzz_npy`", "Ranks.detect", ":6: the promise has no test"),
    ("docs/promises.md", "design.md#steps", "desing.md#steps", ":5: no page desing.md"),
    ("docs/promises.md", "[design](design.md#steps)", "design", ":5: no page says the promise"),
    ("docs/promises.md", "| Ranks agree. |", "| Boxes touch. |", ":6: line 5 has the same promise"),
    ("docs/promises.md", "| Ranks agree. | [design](design.md) |", "| Ranks agree. |", ":6: a row needs a promise, pages and tests"),
    ("docs/promises.md", "| promise | said in | held by |", "| promise | page | test |", ":5: a table has the columns promise | page | test"),
    ("docs/promises.md", "Times depend on the machine.", "", ":11: a promise without a test needs a reason"),
    ("docs/promises.md", PAGE, "# Promises\n", "no promise is held by a test"),
    ("tests/CMakeLists.txt", "boxes_test.cpp", "other_test.cpp", "no test Boxes.Touch"),
    ("tests/CMakeLists.txt", "list(APPEND scripts serve)", "", "no test Ranks.serve"),
    ("tests/CMakeLists.txt", "add_fuzzer(fuzz_npy)", "", "no test fuzz_npy"),
    ("tests/boxes_test.cpp", "INSTANTIATE_TEST_SUITE_P(All, BoxesOf, Values(1));", "", "no test BoxesOf.Each"),
    ("tests/boxes_test.cpp", "TYPED_TEST_SUITE(BoxesIn, Both);", "", "no test BoxesIn.Both"),
    ("tests/test_pairs.py", "test_bytes", "check_bytes", "no test test_pairs.py::Pairs.test_bytes"),
]


def run(changed=None, right="", wrong=""):
    """Returns the status and the output of tools/promises.py in the tree, with one text of one file replaced."""
    with tempfile.TemporaryDirectory() as folder:
        for name, text in TREE.items():
            path = pathlib.Path(folder, name)
            path.parent.mkdir(exist_ok=True)
            assert name != changed or right in text, right
            path.write_text(text.replace(right, wrong, 1) if name == changed else text, encoding="utf-8")
        printed = io.StringIO()
        with mock.patch.object(sys, "argv", ["promises.py", folder]), contextlib.redirect_stdout(printed):
            return promises.main(), printed.getvalue()


class Faults(unittest.TestCase):
    def test_tree_without_fault(self):
        self.assertEqual(run(), (0, "3 promises have tests, 1 have none\n"))

    def test_planted_faults(self):
        for name, right, wrong, message in FAULTS:
            with self.subTest(message):
                status, printed = run(name, right, wrong)
                self.assertEqual(status, 1)
                self.assertIn(message, printed)


if __name__ == "__main__":
    unittest.main()
