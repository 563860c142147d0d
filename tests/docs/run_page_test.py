#!/usr/bin/env python3
"""Plants a fault in each kind of block. run_page.py must report each fault with its line, and accept the page without it."""
import pathlib
import subprocess
import sys
import tempfile
import unittest

RUNNER = pathlib.Path(__file__).parent / "run_page.py"
# Name of the fault, the right line, the wrong line, and what the message must have.
FAULTS = [
    ("a command that fails", "echo one", "false", "line 3: exit status 1"),
    ("a command in the middle that fails", "echo two", "false; echo two", "line 4: exit status 1"),
    ("an unknown command", "echo two", "no_such_command", "line 4: no_such_command"),
    ("an unset variable", "echo two", "echo $unset", "unset: unbound variable"),
    ("another output", "two 12.5 ms", "too 12.5 ms", ":8: the output differs"),
    ("a missing line of output", "two 12.5 ms", "", ":8: the output differs"),
    ("a number that is not marked", "found 7 pairs on 2 threads", "found 8 pairs on 2 threads", ":8: the output differs"),
    ("a Python error", "print(x)", "print(y)", "line 21"),
    ("another output of Python", "41", "42", ":24: the output differs"),
    ("a C++ error", "return 0;", "return zero;", "zero"),
    ("a file that no block uses", "file=main.cpp", "file=other.cpp", ":28: no later block uses the file other.cpp"),
    ("another byte", "A1", "A2", "wrong.bin: bytes 1 to 1 are A1"),
    ("a missing byte", "2..3   20 x2      spaces", "", "bytes from 2 to 3 are not shown"),
    ("a language that is not run", "```text bytes=wrong.bin", "```yaml", "40: the test does not run a block 'yaml'"),
]
PAGE = r"""
```sh
echo one
echo two
```

<!-- varies: \d+ threads -->
```text
one
two 12.5 ms
found 7 pairs on 2 threads
...
```

The first block prints more. Here it ends.

```python
x = 40

x += 1
print(x)
```

```text
41
```

```cpp file=main.cpp
int main() {
    return 0;
}
```

```sh
g++ main.cpp -o main
./main
printf 'A\xa1  ' > wrong.bin
```

```text bytes=wrong.bin
0      41         a letter
1      A1         a byte
2..3   20 x2      spaces
```
"""
RIGHT = PAGE.replace("echo two\n", "echo two 3.25 ms; echo found 7 pairs on 16 threads; echo more; sleep 0 &\n")


def run(text):
    with tempfile.TemporaryDirectory() as folder:
        page = pathlib.Path(folder) / "page.md"
        page.write_text(text, encoding="utf-8")
        return subprocess.run([sys.executable, str(RUNNER), str(page)], capture_output=True, text=True)


class Faults(unittest.TestCase):
    def test_page_without_fault(self):
        done = run(RIGHT)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)

    def test_planted_faults(self):
        for name, right, wrong, message in FAULTS:
            with self.subTest(name):
                self.assertIn(right, RIGHT)
                done = run(RIGHT.replace(right, wrong, 1))
                self.assertEqual(done.returncode, 1, done.stdout + done.stderr)
                self.assertIn(message, done.stdout)

    def test_page_without_blocks(self):
        self.assertIn("no blocks", run("# A page\n").stdout)

    def test_block_without_end(self):
        self.assertIn(":3: the block has no end", run("# A page\n\n```sh\necho\n").stdout)


if __name__ == "__main__":
    unittest.main()
