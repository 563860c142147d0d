"""Sessions that run the blocks of a page: one shell and one Python interpreter for all blocks.

A session reads the names of files from its input, runs them and answers with one line each through a pipe. Standard output and
standard error of a block go to one file.
"""
import os
import select
import signal
import subprocess

PYTHON = """
import os, sys, traceback
answers = int(sys.argv[1])
scope = {"__name__": "__main__"}
for name in map(str.strip, sys.stdin):
    output = os.open(name + ".out", os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
    os.dup2(output, 1), os.dup2(output, 2)
    os.close(output)
    status = 0
    try:
        exec(compile(open(name, encoding="utf-8").read(), name, "exec"), scope)
    except BaseException:
        traceback.print_exc()
        status = 1
    sys.stdout.flush(), sys.stderr.flush()
    os.write(answers, f"{status}\\n".encode())
"""


class Session:
    def __init__(self, folder):
        self.folder, self.process, self.answers, self.count = folder, None, None, 0

    def command(self, answers):
        """Returns the program with its arguments. `answers` is the file descriptor for answers."""
        raise NotImplementedError

    def line(self, name, answers):
        """Returns the line that makes the session run a file."""
        raise NotImplementedError

    def start(self):
        self.answers, self.writer = os.pipe()
        self.process = subprocess.Popen(self.command(self.writer), stdin=subprocess.PIPE, cwd=self.folder, text=True,
                                        pass_fds=[self.writer], start_new_session=True)
        os.close(self.writer)

    def run(self, text, seconds):
        """Runs a block. Returns whether it ended well, and its output."""
        if self.process is None:
            self.start()
        self.count += 1
        name = self.folder / f".{type(self).__name__.lower()}-{self.count}"
        name.write_text(text, encoding="utf-8")
        self.process.stdin.write(self.line(name, self.writer) + "\n")
        self.process.stdin.flush()
        ready, _, _ = select.select([self.answers], [], [], seconds)
        answer = os.read(self.answers, 100).decode().strip() if ready else f"no end after {seconds} s"
        output = name.with_name(name.name + ".out")
        printed = output.read_text(encoding="utf-8", errors="replace") if output.exists() else ""
        return answer == "0", printed if ready else f"{printed}\n{answer}\n"

    def end(self):
        """Ends the session and all processes that its blocks left."""
        if self.process is None:
            return
        self.process.stdin.close()
        try:
            os.killpg(self.process.pid, signal.SIGKILL)
        except ProcessLookupError:
            pass
        self.process.wait()
        os.close(self.answers)


class Shell(Session):
    def command(self, answers):
        return ["bash", "--norc", "-Eeuo", "pipefail"]

    def line(self, name, answers):
        # Without the pipe in the block, its end is seen when the shell ends, also if a program of the block stays.
        trap = "trap 'echo line $LINENO: exit status $? >&2' ERR"
        return f"{trap}; {{ . '{name}'; }} > '{name}.out' 2>&1 < /dev/null {answers}>&-; echo $? >&{answers}"


class Python(Session):
    def __init__(self, folder, program):
        super().__init__(folder)
        self.program = program

    def command(self, answers):
        return [self.program, "-c", PYTHON, str(answers)]

    def line(self, name, answers):
        return str(name)
