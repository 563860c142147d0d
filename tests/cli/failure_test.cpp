// Tests failures at run time: the documented exit status, a clear message, and no partial files.
#include <cmath>

#include "cli/program.hpp"

#include <tuple>
#include "support/compare.hpp"
#include "support/foretold.hpp"

namespace octopair::test {
namespace {

class Failure : public ProgramTest {
protected:
    void save_rows(const std::string& name, const std::vector<float>& rows) const {
        write_file(file(name), npy_of(io::NpyType::float32, {rows.size() / 6, 6}, rows));
    }
    void generate(const std::string& kind, int objects) const {
        ASSERT_EQ(
            run("generate " + kind + " --objects " + std::to_string(objects) + " --seed 1 --output big.npy --quiet")
                .status,
            0);
    }
    /// Returns whether a disk of 1 MB can be mounted here.
    bool can_mount() const {
        return shell("mkdir -p disk && mount -t tmpfs -o size=1m tmpfs disk && umount disk").status == 0;
    }
};

TEST_F(Failure, PrintsNoControlCharactersOfNames) {
    EXPECT_EQ(run("detect \"$(printf '\\033[2Jred\\177\\r.npy')\"").err,
              "octopair: ?[2Jred??.npy: cannot open: No such file or directory\n");
}

TEST_F(Failure, RefusesInvalidBoxes) {
    save_boxes("good.npy", {0, 1, 2});
    auto rows = rows_of({0, 1, 2});
    rows[6 + 1] = NAN;
    save_rows("nan.npy", rows);
    rows[6 + 1] = INFINITY;
    save_rows("inf.npy", rows);
    rows[6 + 1] = 1.5f;
    save_rows("inverted.npy", rows);
    write_file(file("old.csv"), "old");
    const std::string files[3] = {"nan.npy", "inf.npy", "inverted.npy"};
    const std::string words[3] = {"min y is nan, not a finite number", "min y is inf, not a finite number",
                                  "min y 1.5 is above max y 1"};
    for (int i = 0; i < 3; ++i) {
        const std::string message = "octopair: " + files[i] + ": object 1: " + words[i] + "\n";
        for (const std::string output : {" --output new.npy", " --output old.csv", "", " --count-only"}) {
            const Outcome outcome = run("detect good.npy " + files[i] + output);
            EXPECT_EQ(outcome.status, 3);
            EXPECT_EQ(outcome.out, "");
            EXPECT_EQ(outcome.err, message);
            EXPECT_EQ(run("detect good.npy --against " + files[i] + output).err, message);
        }
    }
    EXPECT_EQ(content("old.csv"), "old");
    EXPECT_EQ(directory_.names(),
              (std::vector<std::string>{"good.npy", "inf.npy", "inverted.npy", "nan.npy", "old.csv"}));
}

TEST_F(Failure, ABadFrameLeavesNoFramesBefore) {
    auto rows = rows_of({0, 1, 2, 3});
    rows[3 * 6] = NAN;
    write_file(file("m.npy"), npy_of(io::NpyType::float32, {2, 2, 6}, rows));
    const Outcome outcome = run("detect m.npy --output p.npy");
    EXPECT_EQ(outcome.status, 3);
    EXPECT_EQ(outcome.err, "octopair: m.npy: frame 1: object 1: min x is nan, not a finite number\n");
    EXPECT_EQ(directory_.names(), std::vector<std::string>{"m.npy"});
}

TEST_F(Failure, RefusesInvalidFiles) {
    write_file(file("text.npy"), "hello");
    write_file(file("short.csv"), "0,0,0,1,1,1\n1,2\n");
    save_boxes("a.npy", {0, 1});
    write_file(file("pad.npy"), npy_of<double>(io::NpyType::float64, {3}, {0, 0, 0}));
    EXPECT_EQ(run("detect text.npy").status, 3);
    EXPECT_EQ(run("detect short.csv").err, "octopair: short.csv: line 2: 2 fields, not 6 numbers\n");
    EXPECT_EQ(run("detect a.npy --padding pad.npy").err, "octopair: pad.npy: 3 paddings for 2 objects\n");
    EXPECT_EQ(run("detect .").status, 3);
    const Outcome missing = run("detect a.npy missing.npy");
    EXPECT_EQ(missing.status, 4);
    EXPECT_EQ(missing.err, "octopair: missing.npy: cannot open: No such file or directory\n");
}

TEST_F(Failure, PlacesThatCannotBeWritten) {
    save_boxes("a.npy", {0, 1});
    for (const std::string ending : {".npy", ".csv", ".jsonl"}) {
        const Outcome outcome = run("detect a.npy --output none/p" + ending);
        EXPECT_EQ(outcome.status, 4);
        EXPECT_EQ(outcome.err, "octopair: none/p" + ending + ": cannot create: No such file or directory\n");
    }
    EXPECT_EQ(run("detect a.npy --stats none/s.json").status, 4);
    EXPECT_EQ(run("detect a.npy --stats none/s.json --output p.csv").status, 4);
    EXPECT_EQ(directory_.names(), std::vector<std::string>{"a.npy"});
    EXPECT_EQ(run("generate uniform --objects 5 --output none/a.npy").status, 4);
    EXPECT_EQ(run("detect a.npy >/dev/full").err, "octopair: standard output: cannot write: No space left on device\n");
}

TEST_F(Failure, AFullDiskLeavesTheOldFile) {
    if (!can_mount()) GTEST_SKIP() << "no permission to mount a disk";
    generate("coincident", 2000);
    for (const std::string name : {"p.npy", "p.csv", "p.jsonl"}) {
        const Outcome outcome = shell("mount -t tmpfs -o size=1m tmpfs disk && echo old >disk/" + name +
                                      "; \"$P\" detect big.npy --output disk/" + name +
                                      "; status=$?; cat disk/*; ls -A disk; umount disk; exit $status");
        EXPECT_EQ(outcome.status, 4) << name;
        EXPECT_EQ(outcome.err, "octopair: disk/" + name + ": cannot write: No space left on device\n");
        EXPECT_EQ(outcome.out, "old\n" + name + "\n");
    }
    const Outcome generated = shell(
        "mount -t tmpfs -o size=1m tmpfs disk; \"$P\" generate uniform --objects 100000 --output disk/a.npy; "
        "status=$?; "
        "ls -A disk; umount disk; exit $status");
    EXPECT_EQ(generated.status, 4);
    EXPECT_EQ(generated.out, "");
}

TEST_F(Failure, AFileSizeLimitLeavesTheOldFile) {
    generate("coincident", 2000);
    write_file(file("p.npy"), "old");
    const Outcome outcome = shell("ulimit -f 1000; \"$P\" detect big.npy --output p.npy");
    EXPECT_EQ(outcome.status, 4);
    EXPECT_EQ(outcome.err, "octopair: p.npy: cannot write: File too large\n");
    EXPECT_EQ(content("p.npy"), "old");
    EXPECT_EQ(directory_.names(), (std::vector<std::string>{"big.npy", "p.npy"}));
}

/// A result of 256 MiB or more is compared with the free space before it is written.
TEST_F(Failure, AResultThatCannotFitIsForetold) {
    generate("coincident", 9000);  // 40,495,500 pairs
    write_file(file("p.npy"), "old");
    const std::string advice =
        ", 307 MB are allowed for a file (ulimit -f); use --count-only, --limit or a stream (without --output)\n";
    const auto limited = [&](const std::string& arguments) {
        return shell("ulimit -f 600000; \"$P\" detect big.npy " + arguments);
    };
    for (const std::string options : {"", " --order octal"}) {
        const Outcome outcome = limited("--output p.npy" + options);
        EXPECT_EQ(outcome.status, 5);
        EXPECT_EQ(outcome.out, "");
        EXPECT_TRUE(foretells(outcome.err, "octopair: p.npy: 40,495,500 pairs need 324 MB" + advice)) << outcome.err;
    }
    for (const auto& [name, bytes] : {std::pair("p.csv", "at least 375 MB"), {"p.jsonl", "at least 780 MB"}}) {
        const Outcome outcome = limited(std::string("--output ") + name);
        EXPECT_EQ(outcome.status, 5);
        const std::string exact = std::string("octopair: ") + name + ": 40,495,500 pairs need " + bytes + advice;
        EXPECT_TRUE(foretells(outcome.err, exact)) << outcome.err;
    }
    EXPECT_EQ(content("p.npy"), "old");
    EXPECT_EQ(directory_.names(), (std::vector<std::string>{"big.npy", "p.npy"}));
    EXPECT_EQ(limited("--count-only --quiet").out, "40495500\n");
    EXPECT_EQ(limited("--quiet | tail -n 1").out, "8998,8999\n");
    EXPECT_EQ(limited("--limit 1000 --output p.npy --quiet").status, 0);
    EXPECT_EQ(content("p.npy").size(), 128u + 8000);
}

TEST_F(Failure, AFullDiskIsForetold) {
    if (!can_mount()) GTEST_SKIP() << "no permission to mount a disk";
    generate("coincident", 9000);
    const Outcome outcome = shell(
        "mount -t tmpfs -o size=1m tmpfs disk; \"$P\" detect big.npy --output disk/p.npy; status=$?; ls -A disk; "
        "umount disk; exit $status");
    EXPECT_EQ(outcome.status, 5);
    EXPECT_TRUE(foretells(outcome.err,
                          "octopair: disk/p.npy: 40,495,500 pairs need 324 MB, 1.05 MB are free on its file system; "
                          "use --count-only, --limit or a stream (without --output)\n"))
        << outcome.err;
    EXPECT_EQ(outcome.out, "");
}

TEST_F(Failure, AClosedPipe) {
    generate("coincident", 2000);
    const Outcome outcome = shell("{ \"$P\" detect big.npy; echo $? >status; } | head -n 2; cat status");
    EXPECT_EQ(outcome.out, "a,b\n0,1\n4\n");
    EXPECT_EQ(outcome.err, "octopair: standard output: cannot write: Broken pipe\n");
}

TEST_F(Failure, AnInterruptLeavesTheOldFile) {
    generate("coincident", 60000);  // 1,799,970,000 pairs: seconds of work
    write_file(file("p.npy"), "old");
    for (const auto& [signal, status, words] :
         {std::tuple<std::string, int, std::string>("INT", 130, "interrupted"), {"TERM", 143, "terminated"}}) {
        const Outcome outcome =
            shell("\"$P\" detect big.npy --output p.npy & child=$!; hears $child; sleep 0.2; kill -" + signal +
                  " $child; wait $child");
        EXPECT_EQ(outcome.status, status);
        EXPECT_EQ(outcome.err, "octopair: " + words + "\n");
        EXPECT_EQ(content("p.npy"), "old");
        EXPECT_EQ(directory_.names(), (std::vector<std::string>{"big.npy", "p.npy"}));
    }
}

TEST_F(Failure, AFullDiskUnderShortTexts) {
    for (const char* words : {"--help", "--version", "info", "detect --help"}) {
        const Outcome outcome = shell("\"$P\" " + std::string(words) + " >/dev/full");
        EXPECT_EQ(outcome.status, 4) << words;
        EXPECT_EQ(outcome.err, "octopair: standard output: cannot write: No space left on device\n") << words;
    }
}

TEST_F(Failure, NoOutputReplacesAnInput) {
    save_boxes("a.npy", {0, 0.5f});
    save_boxes("b.npy", {0, 0.5f});
    const std::string before = content("a.npy");
    ASSERT_EQ(shell("ln -s a.npy link.npy && ln a.npy hard.npy && mkdir d && ln -s ../a.npy d/up.npy").status, 0);
    std::vector<std::string> all_wrong = {"a.npy --output a.npy",
                                          "a.npy --output ./a.npy",
                                          "a.npy --output link.npy",
                                          "link.npy --output hard.npy",
                                          "a.npy --output d/up.npy",
                                          "a.npy --stats a.npy",
                                          "b.npy a.npy --output a.npy",
                                          "b.npy --against a.npy --output a.npy",
                                          "b.npy --padding a.npy --output a.npy"};
#ifdef OCTOPAIR_WITH_SERVICE
    all_wrong.emplace_back("b.npy --engine unix:s --token-file a.npy --output a.npy");
#endif
    for (const std::string& wrong : all_wrong) {
        const Outcome outcome = run("detect " + wrong);
        EXPECT_EQ(outcome.status, 2) << wrong;
        EXPECT_TRUE(has_text(outcome.err, "which would be replaced"));
        EXPECT_EQ(content("a.npy"), before) << wrong;
    }
}

TEST_F(Failure, AReplacedFileKeepsItsMode) {
    save_boxes("a.npy", {0, 0.5f});
    write_file(file("p.csv"), "old");
    ASSERT_EQ(shell("chmod 640 p.csv && \"$P\" detect a.npy --output p.csv --quiet && stat -c %a p.csv").out, "640\n");
    EXPECT_EQ(content("p.csv"), "a,b\n0,1\n");
    EXPECT_EQ(shell("umask 027; \"$P\" detect a.npy --output new.csv --quiet && stat -c %a new.csv").out, "640\n");
}

TEST_F(Failure, AnInterruptWhileAPipeIsFull) {
    generate("coincident", 2000);
    // The reader reads nothing before the program ends, so only the stop request can end the program.
    const Outcome outcome = shell(
        "mkfifo pipe; sh -c 'exec <pipe; while [ ! -e status ]; do sleep 0.05; done' & "
        "\"$P\" detect big.npy >pipe & child=$!; hears $child; sleep 0.2; kill -INT $child; wait $child; status=$?; "
        "echo >status; wait; exit $status");
    EXPECT_EQ(outcome.status, 130) << outcome.err;
}

TEST_F(Failure, ASecondInterruptKills) {
    // A stopped process receives both signals when it continues. So it has no time to end between the signals.
    generate("coincident", 60000);
    const Outcome outcome = shell(
        "\"$P\" detect big.npy --output p.npy & child=$!; hears $child; sleep 0.2; kill -STOP $child; "
        "kill -TERM $child; kill -INT $child; kill -CONT $child; wait $child");
    EXPECT_TRUE(outcome.status == 128 + 2 || outcome.status == 128 + 15) << outcome.status;
    EXPECT_EQ(directory_.names(), std::vector<std::string>{"big.npy"});
}

#ifndef OCTOPAIR_TEST_SANITIZED
// The timing of threads may decide whether little memory is enough. In any case the file must be complete or absent.
TEST_F(Failure, TooLittleMemory) {
    generate("uniform", 1'000'000);
    ASSERT_EQ(shell("\"$P\" detect big.npy --output all.npy --quiet").status, 0);
    const std::string all = read_file(file("all.npy"));
    bool failed = false;
    for (int mebibytes = 200; mebibytes >= 40; mebibytes -= 20) {
        const Outcome outcome =
            shell("ulimit -v " + std::to_string(mebibytes * 1024) + "; \"$P\" detect big.npy --output p.npy --quiet");
        if (outcome.status == 127) break;  // too little memory to load the program
        if (outcome.status == 0) {
            EXPECT_TRUE(same_sequence(read_file(file("p.npy")), all)) << mebibytes << " MiB";
            std::filesystem::remove(file("p.npy"));
            continue;
        }
        failed = true;
        EXPECT_EQ(outcome.status, 5) << mebibytes << " MiB: " << outcome.err;
        EXPECT_TRUE(outcome.err.starts_with("octopair: ")) << outcome.err;
        EXPECT_EQ(directory_.names(), (std::vector<std::string>{"all.npy", "big.npy"}));
    }
    EXPECT_TRUE(failed);
}
#endif

}  // namespace
}  // namespace octopair::test
