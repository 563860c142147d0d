// Tests `octopair submit`, `status`, `result` and `cancel`.
#include "cli/program.hpp"

namespace octopair::test {
namespace {

class JobProgramTest : public ProgramTest {
protected:
    /// Runs a script while a server runs. OCTOPAIR_SERVER holds the server's address.
    Outcome with_server(const std::string& script, const std::string& serve = "--state state") const {
        return shell("rm -f log; \"$P\" serve --listen unix:socket " + serve +
                     " 2>log & S=$!; trap 'kill $S; wait $S' EXIT\nexport OCTOPAIR_SERVER=unix:socket\n" +
                     "for i in $(seq 1200); do [ -s log ] && break; sleep 0.05; done\n" + script);
    }
};

TEST_F(JobProgramTest, WritesWhatDetectWrites) {
    save_boxes("a.npy", {0, 0.5, 3, 3.5, 9});
    save_boxes("b.npy", {1, 9.5});
    for (const char* const what :
         {"a.npy", "a.npy --against b.npy", "a.npy b.npy --margin 1 --order octal --limit 3"}) {
        for (const char* const ending : {"npy", "csv", "jsonl"}) {
            const std::string files = std::string("there.") + ending + " here." + ending;
            const Outcome outcome =
                with_server(std::string("id=$(\"$P\" submit ") + what +
                            ") && \"$P\" result $id --release --quiet --output there." + ending + " && \"$P\" detect " +
                            what + " --quiet --output here." + ending + " && cmp " + files + " && \"$P\" status");
            EXPECT_EQ(outcome.status, 0) << what << outcome.err;
            EXPECT_EQ(outcome.out, "") << "the job was not released";
        }
    }
}

TEST_F(JobProgramTest, PrintsJobs) {
    save_boxes("a.npy", {0, 0.5, 3});
    const std::string id = "01234567-89ab-cdef-0123-456789abcdef";
    const Outcome outcome =
        with_server("\"$P\" submit a.npy --id " + id + "\n\"$P\" status " + id +
                    " --wait 60\n\"$P\" status\n\"$P\" result " + id + " --quiet\n\"$P\" cancel " + id);
    const std::string line = id + "  done, 3 objects, 1 pairs\n";
    EXPECT_EQ(outcome.out, id + "\n" + line + line + "a,b\n0,1\n" + line) << outcome.err;
    const Outcome json = with_server("\"$P\" status " + id + " --json; \"$P\" status --json");
    EXPECT_TRUE(has_text(json.out, "\"state\": \"done\"")) << json.err;
    EXPECT_TRUE(has_text(json.out, "[\n"));
}

TEST_F(JobProgramTest, CountsAlone) {
    save_boxes("a.npy", {0, 0.5, 3});
    const Outcome outcome =
        with_server("id=$(\"$P\" submit a.npy --count-only); \"$P\" result $id; \"$P\" result $id --output a.csv");
    EXPECT_EQ(outcome.out, "1\n");
    EXPECT_EQ(outcome.status, 2) << outcome.err;
}

TEST_F(JobProgramTest, ShowsATokenWhereOneIsWanted) {
    save_boxes("a.npy", {0, 0.5, 3});
    ASSERT_EQ(shell("umask 077; echo anna 0123456789abcdef > tokens; echo 0123456789abcdef > anna").status, 0);
    const std::string id = "01234567-89ab-cdef-0123-456789abcdef";
    const Outcome outcome =
        with_server("\"$P\" submit a.npy --id " + id + "; \"$P\" submit a.npy --token-file anna --id " + id +
                        "\nexport OCTOPAIR_TOKEN=0123456789abcdef\n\"$P\" result " + id +
                        " --quiet --release && \"$P\" status && \"$P\" cancel " + id,
                    "--state state --tokens tokens");
    EXPECT_EQ(outcome.out, id + "\na,b\n0,1\n");
    EXPECT_TRUE(has_text(outcome.err, "the server requires a token"));
    EXPECT_TRUE(has_text(outcome.err, "there is no job"));
}

TEST_F(JobProgramTest, TellsWhatWasCancelled) {
    save_boxes("a.npy", {0, 0.5, 3});
    const std::string id = "01234567-89ab-cdef-0123-456789abcdef";
    ASSERT_EQ(shell("\"$P\" generate coincident --objects 200000 --output crowd.npy").status, 0);
    const Outcome outcome = with_server("\"$P\" submit crowd.npy --count-only --id " + id + "\n\"$P\" cancel " + id +
                                        " >cancelled; \"$P\" status --wait 60 " + id + "; \"$P\" result " + id);
    EXPECT_EQ(outcome.status, 6);
    EXPECT_EQ(outcome.out, id + "\n" + id + "  cancelled, 200,000 objects\n");
    EXPECT_EQ(outcome.err, "octopair: job " + id + " was cancelled\n");
    const Outcome released = with_server("\"$P\" cancel --release " + id + "; \"$P\" status");
    EXPECT_EQ(released.status, 0) << released.err;
    EXPECT_EQ(released.out, id + "  cancelled, 200,000 objects\n") << "the job was not released";
}

TEST_F(JobProgramTest, SaysWhatIsWrong) {
    save_boxes("a.npy", {0, 0.5, 3});
    const std::string id = " 01234567-89ab-cdef-0123-456789abcdef";
    EXPECT_EQ(shell("unset OCTOPAIR_SERVER; \"$P\" status").status, 2);
    EXPECT_EQ(with_server("\"$P\" submit a.npy", "").status, 2);
    EXPECT_EQ(with_server("\"$P\" status" + id).status, 3);
    EXPECT_EQ(with_server("\"$P\" result" + id).status, 3);
    EXPECT_EQ(with_server("\"$P\" submit a.npy --id x").status, 3);
    EXPECT_EQ(with_server("\"$P\" submit a.npy --id" + id + " && \"$P\" submit a.npy --margin 1 --id" + id).status, 3);
    EXPECT_EQ(with_server("\"$P\" submit a.npy", "--state /proc/none").status, 6);
    EXPECT_EQ(with_server("\"$P\" status ''").status, 2);
}

}  // namespace
}  // namespace octopair::test
