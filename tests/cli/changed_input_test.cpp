// Tests `octopair detect` on a mapped file that changes while pairs are written.
#include <filesystem>
#include <fstream>

#include "cli/program.hpp"
#include "io/boxes/npy.hpp"

namespace octopair::test {
namespace {

class ChangedInput : public ProgramTest {
protected:
    /// Objects of the file. It is mapped, because it is large. Most of it is a hole, which reads as boxes at the origin.
    static constexpr std::uint64_t objects = io::NpyScene::min_mapped_bytes / sizeof(Box3f) + 10'000, at_end = 400;

    ChangedInput() {
        const std::vector<float> rows = rows_of(std::vector<float>(at_end, 10));
        const std::string few = npy_of(io::NpyType::float32, {at_end, 6}, rows);
        write_file(file("few.npy"), few);
        const std::string header = npy_of(io::NpyType::float32, {objects, 6}, std::vector<float>()).substr(0, 128);
        write_file(file("large.npy"), header);
        std::filesystem::resize_file(file("large.npy"), 128 + (objects - at_end) * sizeof(Box3f));
        std::ofstream(file("large.npy"), std::ios::binary | std::ios::app) << few.substr(128);
    }

    /// Changes the file by a line of sh after the first line of the result was written. The result does not fit into the pipe, so the
    /// program waits with the rest. Prints the number of pairs.
    Outcome change(const std::string& line, const std::string& engine = "local") const {
        return shell("mkfifo pipe; \"$P\" detect large.npy --against few.npy --quiet --engine " + engine +
                     " >pipe & child=$!; exec 3<pipe; read head <&3; " + line +
                     "; cat <&3 >pairs; wait $child; status=$?; rm pipe; wc -l <pairs; exit $status");
    }
    std::string message(const std::string& what) const { return "octopair: large.npy: the file " + what + "\n"; }

    const std::string truncated = message("was truncated while it was read");
    const std::string changed = message("changed while it was read; run again when no program writes to it");
};

TEST_F(ChangedInput, ThatIsCutShortIsRefused) {
    const Outcome outcome = change("truncate -s -3 large.npy");
    EXPECT_EQ(outcome.status, 3);
    EXPECT_EQ(outcome.err, truncated);
}

#ifdef OCTOPAIR_WITH_PROCESSES
TEST_F(ChangedInput, ThatIsCutShortIsRefusedByWorkerProcesses) {
    const Outcome outcome = change("truncate -s -3 large.npy", "processes --workers 2");
    EXPECT_EQ(outcome.status, 3);
    EXPECT_EQ(outcome.err, truncated);
}
#endif

#ifdef OCTOPAIR_WITH_SERVICE
TEST_F(ChangedInput, ThatIsCutShortIsRefusedWithAServer) {
    const Outcome outcome = shell(
        "\"$P\" serve --listen unix:socket 2>log & server=$!\n"
        "for i in $(seq 1200); do grep -qs started log && break; sleep 0.05; done\n"
        "mkfifo pipe; \"$P\" detect large.npy --against few.npy --quiet --engine unix:socket >pipe & child=$!\n"
        "exec 3<pipe; read head <&3; truncate -s -3 large.npy; cat <&3 >pairs; wait $child; status=$?\n"
        "kill $server; wait $server; exit $status");
    EXPECT_EQ(outcome.status, 3);
    EXPECT_EQ(outcome.err, truncated);
}
#endif

TEST_F(ChangedInput, ThatIsWrittenIsRefused) {
    for (const std::string line :
         {"echo >>large.npy", "dd if=/dev/zero of=large.npy bs=9 count=1 seek=999 conv=notrunc status=none",
          "truncate -s -100M large.npy; truncate -s +100M large.npy"}) {
        const Outcome outcome = change(line);
        EXPECT_EQ(outcome.status, 3) << line;
        EXPECT_EQ(outcome.err, changed) << line;
        const auto bytes = 128 + objects * sizeof(Box3f);
        std::filesystem::resize_file(file("large.npy"), bytes);
    }
}

TEST_F(ChangedInput, ThatIsReplacedIsReadToItsEnd) {
    const Outcome outcome = change("cp few.npy new.npy; mv new.npy large.npy");
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_EQ(outcome.out, std::to_string(at_end * at_end) + "\n");
}

}  // namespace
}  // namespace octopair::test
