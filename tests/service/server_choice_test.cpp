// Tests `octopair detect --engine ADDRESS`: the options for a server, and the messages about them.
#include <nlohmann/json.hpp>

#include "cli/program.hpp"

namespace octopair::test {
namespace {

class ServerChoice : public ProgramTest {
protected:
    ServerChoice() {
        save_boxes("a.npy", {0, 10, 0.5});
        write_file(file("tokens"), "anna 0123456789abcdef\n");
        write_file(file("token"), "0123456789abcdef\n");
        write_file(file("wrong"), "0123456789abcdeg\n");
        write_file(file("roles"), "");
    }
    /// Runs commands with a server at unix:socket that requires a token.
    Outcome with_server(const std::string& lines) const {
        return shell(R"(chmod 600 tokens token wrong roles
            "$P" serve --listen unix:socket --threads 1 --tokens tokens --roles roles 2>log & child=$!
            for i in $(seq 1200); do grep -qs started log && break; sleep 0.05; done
            D='detect a.npy --engine unix:socket'
            )" + lines +
                     "\nstatus=$?; kill $child; wait $child; exit $status");
    }
};

TEST_F(ServerChoice, TokensComeFromAFileOrTheEnvironment) {
    const std::string answer = "a,b\n0,2\n";
    EXPECT_EQ(with_server("\"$P\" $D --quiet --token-file token").out, answer);
    EXPECT_EQ(with_server("OCTOPAIR_TOKEN=0123456789abcdef \"$P\" $D --quiet").out, answer);
    EXPECT_EQ(with_server("OCTOPAIR_TOKEN=other \"$P\" $D --quiet --token-file token").out, answer);
    const Outcome refused = with_server("\"$P\" $D --quiet --token-file wrong"),
                  none = with_server("\"$P\" $D --quiet");
    EXPECT_EQ(refused.status, 2);
    EXPECT_EQ(refused.err, "octopair: unix:socket: the server does not accept this token\n");
    EXPECT_EQ(none.status, 2);
    EXPECT_EQ(none.err, "octopair: unix:socket: the server requires a token\n");
}

TEST_F(ServerChoice, EventsAskWithTheSameToken) {
    const Outcome outcome = with_server("\"$P\" $D --events --quiet --token-file token");
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_EQ(outcome.out, "frame,event,a,b\n0,begin,0,2\n");
}

TEST_F(ServerChoice, AHangUpReadsTheTokensAgain) {
    const Outcome outcome = with_server(
        "install -m 600 /dev/null new && echo fedcba9876543210 >new\n"
        "reads() { for i in $(seq 600); do grep -qs \"$1\" log && return; sleep 0.05; done; }\n"
        "\"$P\" $D --quiet --count-only --token-file new 2>&1\n"
        "echo 'bert fedcba9876543210' >tokens; kill -HUP $child; reads 'info read tokens, roles'\n"
        "\"$P\" $D --quiet --count-only --token-file new; \"$P\" $D --quiet --count-only --token-file token 2>&1\n"
        "echo broken >tokens; kill -HUP $child; reads 'cannot read them again'\n"
        "\"$P\" $D --quiet --count-only --token-file new");
    const std::string refused = "octopair: unix:socket: the server does not accept this token\n";
    EXPECT_EQ(outcome.out, refused + "1\n" + refused + "1\n");
    EXPECT_TRUE(
        has_text(content("log"),
                 "tokens, roles and certificates: cannot read them again: tokens: line 1: a line must be NAME TOKEN"));
}

TEST_F(ServerChoice, TheLogWarnsOfClientsWithoutAToken) {
    const Outcome outcome = with_server(
        "warns() { for i in $(seq 600); do grep -qs \"$1\" log && return; sleep 0.05; done; }\n"
        "printf 'token:anna owner\\ntoken:ana none\\n' >roles; kill -HUP $child; warns 'client token:ana$'");
    EXPECT_EQ(outcome.status, 0);
    EXPECT_TRUE(has_text(content("log"), "warning roles: no token has the name of the client token:ana"));
    EXPECT_FALSE(has_text(content("log"), "client token:anna"));
}

TEST_F(ServerChoice, AHangUpKeepsTheRolesIfTheFileIsNotUnderstood) {
    const Outcome outcome = with_server(
        "reads() { for i in $(seq 600); do grep -qs \"$1\" log && return; sleep 0.05; done; }\n"
        "echo 'token:anna none' >roles; kill -HUP $child; reads 'info read tokens, roles'\n"
        "\"$P\" $D --quiet --count-only --token-file token 2>&1\n"
        "echo '\"token:anna owner' >roles; kill -HUP $child; reads 'cannot read them again'\n"
        "\"$P\" $D --quiet --count-only --token-file token 2>&1");
    const std::string refused = "octopair: unix:socket: the client has no access any more\n";
    EXPECT_EQ(outcome.out, refused + refused);
    EXPECT_TRUE(has_text(content("log"),
                         "tokens, roles and certificates: cannot read them again: roles: line 1: a quote is "
                         "not closed; those read before stay in use"));
}

TEST_F(ServerChoice, TokenFilesOthersMayReadAreRefused) {
    const Outcome outcome = with_server("chmod 644 token; \"$P\" $D --quiet --token-file token");
    EXPECT_EQ(outcome.status, 2);
    EXPECT_EQ(outcome.err,
              "octopair: token: other users can access this secret file; restrict it to its owner (chmod 600)\n");
}

TEST_F(ServerChoice, SummaryAndStatsNameTheServer) {
    const Outcome outcome = with_server("\"$P\" $D --token-file token --stats stats.json");
    EXPECT_EQ(outcome.status, 0);
    EXPECT_TRUE(has_text(outcome.err, " objects/s on server unix:socket\n"));
    const auto stats = nlohmann::json::parse(content("stats.json"));
    EXPECT_EQ(stats["engine"], "server");
    EXPECT_EQ(stats["server"], "unix:socket");
    EXPECT_EQ(stats["threads"], 0);
}

TEST_F(ServerChoice, WhatDoesNotFitIsRefused) {
    for (const std::string options :
         {"--engine unix:socket --threads 2", "--engine unix:socket --workers 2", "--token-file token", "--tls",
          "--tls-authority a.pem", "--engine local --patience 3", "--engine processes --tls-key k",
          "--engine unix:socket --patience -1", "--engine unix:socket --tls-key k",
          "--engine unix:", "--engine host:99999"}) {
        const Outcome outcome = run("detect a.npy --quiet " + options);
        EXPECT_EQ(outcome.status, 2) << options << ": " << outcome.err;
    }
    const Outcome away = run("detect a.npy --quiet --engine unix:none --patience 0.2");
    EXPECT_EQ(away.status, 6);
    EXPECT_EQ(away.err.find("octopair: unix:none: no server answers"), 0u) << away.err;
    EXPECT_TRUE(has_text(run("info").out, ", server (ADDRESS)\n"));
}

}  // namespace
}  // namespace octopair::test
