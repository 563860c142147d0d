// Tests roles of clients, hashed and expiring tokens, and the revocation of access without a restart.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <ctime>
#include <functional>
#include <optional>
#include <set>
#include <tuple>

#include "octopair/job_client.hpp"
#include "octopair/remote_scene.hpp"
#include "octopair/scene_watcher.hpp"
#include "service/guarded.hpp"
#include "support/kinds.hpp"

namespace octopair::test {
namespace {

class Roles : public ::testing::Test {
protected:
    Roles() {
        write_secret(
            folder_.file("tokens"),
            "anna anna-0123456789ab\nbert bert-0123456789ab\nruth ruth-0123456789ab\noleg oleg-0123456789ab\n");
        write_secret(folder_.file("roles"), "# watches anna\ntoken:ruth reader token:anna\n\"token:oleg\" operator\n");
        options_ = options_at("unix:" + folder_.file("socket"));
        options_.token_file = folder_.file("tokens");
        options_.role_file = folder_.file("roles");
        options_.state_folder = folder_.file("state");
        options_.on_drain = [this] { drained_ = true; };
        server_ = std::make_unique<service::Server>(options_, silent());
    }

    std::unique_ptr<JobClient> client(const std::string& name, const std::string& owner = {}) const {
        ClientOptions options{
            .patience = std::chrono::milliseconds(300), .token = name + "-0123456789ab", .owner = owner};
        return std::make_unique<JobClient>(server_->address().text(), options);
    }
    std::string submit(const std::string& name, const std::string& id = {}) const {
        return client(name)->submit({boxes_}, {}, {.id = id});
    }
    std::string refusal_of(const std::string& roles) const {
        write_secret(folder_.file("roles"), roles);
        return error_of(ErrorCode::bad_input, [&] { server_->reload(); });
    }
    const std::string client_forms =
        "a client is token:NAME, certificate:NAME, certificate-uri:NAME, certificate-email:NAME, certificate-dns:NAME "
        "or local, as in the server's log";
    std::string not_permitted(const std::string& role) const {
        return server_->address().text() + ": the role " + role + " does not permit this call";
    }

    TemporaryDirectory folder_;
    service::ServerOptions options_;
    std::atomic<bool> drained_ = false;
    std::unique_ptr<service::Server> server_;
    std::vector<Box3f> boxes_ = make_boxes("uniform", 1000, 1);
};

TEST_F(Roles, AReaderSeesTheJobsOfOneOwner) {
    const std::string of_anna = submit("anna"), of_bert = submit("bert");
    const auto ruth = client("ruth");
    PairList expected, read;
    (void)client("anna")->result(of_anna, expected);
    (void)ruth->result(of_anna, read);
    EXPECT_EQ(read.to_vector(), expected.to_vector());
    EXPECT_GT(read.size(), 0u);
    const std::vector<JobStatus> list = ruth->list();
    ASSERT_EQ(list.size(), 1u);
    EXPECT_EQ(list[0].id, of_anna);
    EXPECT_EQ(list[0].owner, "token:anna");
    EXPECT_EQ(error_of(ErrorCode::bad_input, [&] { ruth->status(of_bert); }), "there is no job " + of_bert);
    for (const auto& call : std::vector<std::function<void()>>{
             [&] { submit("ruth"); }, [&] { ruth->cancel(of_anna); }, [&] { ruth->release(of_anna); },
             [&] { ruth->drain(); }, [&] { (void)ask(server_->address().text(), {.token = "ruth-0123456789ab"}); }})
        EXPECT_EQ(error_of(ErrorCode::usage, call), not_permitted("reader"));
    EXPECT_EQ(client("anna")->list().at(0).owner, "") << "an owner's own jobs";
}

TEST_F(Roles, AnOperatorSeesAndCancelsTheJobsOfAll) {
    const std::string id = "01234567-89ab-cdef-0123-456789abcdef";
    submit("anna", id);
    submit("bert", id);
    const std::string of_bert = submit("bert");
    const auto oleg = client("oleg");
    const std::vector<JobStatus> list = oleg->list();
    ASSERT_EQ(list.size(), 3u);
    EXPECT_EQ(list[0].owner, "token:anna");
    EXPECT_EQ(list[2].owner, "token:bert");
    EXPECT_EQ(oleg->status(of_bert).owner, "token:bert");
    EXPECT_EQ(error_of(ErrorCode::bad_input, [&] { oleg->status(id); }),
              "several owners have a job " + id + "; name the owner");
    EXPECT_EQ(client("oleg", "token:anna")->cancel(id).owner, "token:anna");
    PairList pairs;
    for (const auto& call :
         std::vector<std::function<void()>>{[&] { submit("oleg"); }, [&] { (void)oleg->release(of_bert); }})
        EXPECT_EQ(error_of(ErrorCode::usage, call), not_permitted("operator"));
    EXPECT_EQ(error_of(ErrorCode::usage, [&] { (void)oleg->result(of_bert, pairs); }), not_permitted("operator"));
    EXPECT_FALSE(drained_);
    oleg->drain();
    EXPECT_TRUE(drained_);
}

TEST_F(Roles, AnOwnerNamesNobodyElsesJobs) {
    const std::string of_bert = submit("bert");
    const auto anna = client("anna", "token:bert");
    EXPECT_EQ(error_of(ErrorCode::bad_input, [&] { anna->status(of_bert); }), "there is no job " + of_bert);
    EXPECT_EQ(error_of(ErrorCode::bad_input, [&] { anna->cancel(of_bert); }), "there is no job " + of_bert);
    EXPECT_EQ(error_of(ErrorCode::usage, [&] { anna->drain(); }), not_permitted("owner"));
    EXPECT_FALSE(drained_);
}

TEST_F(Roles, OperatorsListManyJobsOfManyOwners) {
    options_.limits.jobs_per_client = 2000;
    server_.reset();
    server_ = std::make_unique<service::Server>(options_, silent());
    const std::vector<Box3f> few = make_boxes("uniform", 10, 1);
    for (const char* name : {"anna", "bert"}) {
        const auto owner = client(name);
        for (int i = 0; i < 600; ++i) (void)owner->submit({few});
    }
    const std::vector<JobStatus> list = client("oleg")->list();
    EXPECT_EQ(list.size(), 1200u);
    EXPECT_TRUE(std::is_sorted(list.begin(), list.end(), [](const JobStatus& a, const JobStatus& b) {
        return std::tie(a.owner, a.id) < std::tie(b.owner, b.id);
    }));
}

TEST_F(Roles, AccessEndsWithoutARestart) {
    EXPECT_NO_THROW((void)client("bert")->list());
    write_secret(folder_.file("roles"), "token:bert none\n");
    server_->reload();
    EXPECT_EQ(error_of(ErrorCode::usage, [&] { (void)client("bert")->list(); }),
              server_->address().text() + ": the client has no access any more");
    EXPECT_NO_THROW(submit("ruth")) << "an owner again";
}

TEST_F(Roles, InvalidLinesAreRefusedAndChangeNothing) {
    const std::string file = folder_.file("roles");
    EXPECT_EQ(refusal_of("token:anna\n"),
              file + ": line 1: a line must be CLIENT ROLE; roles are owner, reader OWNER, operator and none");
    EXPECT_EQ(refusal_of("\nanna operator\n"), file + ": line 2: " + client_forms);
    EXPECT_EQ(refusal_of("token:anna reader bert\n"), file + ": line 1: " + client_forms);
    for (const char* wrong : {"token:anna reader\n", "token:anna operator token:bert\n", "token:a reader token:b c\n"})
        EXPECT_EQ(refusal_of(wrong),
                  file + ": line 1: the role reader needs the name of one owner; other roles have none");
    EXPECT_EQ(refusal_of("token:anna none\ntoken:anna owner\n"),
              file + ": line 2: an earlier line has the same client");
    EXPECT_EQ(client("oleg")->list().size(), 0u) << "still an operator";
    EXPECT_EQ(error_of(ErrorCode::usage, [&] { submit("oleg"); }), not_permitted("operator"));
}

/// A line that is skipped, or understood in part, would leave its client with all rights.
TEST_F(Roles, LinesThatAreNotWhollyUnderstoodAreRefused) {
    const std::vector<std::pair<std::string, std::string>> lines = {
        {"\"token:anna none", "a quote is not closed"},
        {"\"token:anna\\\" none", "a quote is not closed"},
        {"\"token:anna\\", "a quote is not closed"},
        {"\"", "a quote is not closed"},
        {"token:anna reader \"token:bert", "a quote is not closed"},
        {"\"\" none", "a name in quotes is empty"},
        {"token:anna \"\"", "a name in quotes is empty"},
        {"\"token:anna\"none", "a blank must follow a closing quote"},
        {"\"token:anna\"# none", "a blank must follow a closing quote"},
        {"token:anna\" none", "a name that contains a quote must be in quotes, with \\\" for the quote"},
        {"token:\"anna\" none", "a name that contains a quote must be in quotes, with \\\" for the quote"},
        {std::string("token:anna none\0", 16), "it contains a control character"},
        {"token:anna\fnone", "it contains a control character"},
        {"\"token:\\anna\" none", "in quotes, a backslash must be written as \\\\"},
        {"\"#token:anna\" none", client_forms},
        {"Token:anna none", client_forms},
        {"token: none", "a name must follow the colon, without a blank between them"},
        {"token: anna none", "a name must follow the colon, without a blank between them"},
        {"token:anna reader token:", "a name must follow the colon, without a blank between them"},
        {"token:anna None", "a line must be CLIENT ROLE; roles are owner, reader OWNER, operator and none"},
        {"token:anna none # left", "the role reader needs the name of one owner; other roles have none"},
    };
    const std::string file = folder_.file("roles");
    for (const auto& [line, why] : lines) {
        EXPECT_EQ(refusal_of("\ntoken:bert none\n" + line), file + ": line 3: " + why) << line;
        EXPECT_EQ(refusal_of(line + "\ntoken:bert none\n"), file + ": line 1: " + why) << line;
        EXPECT_NO_THROW((void)client("bert")->list()) << "the roles read before stay in use";
        EXPECT_EQ(error_of(ErrorCode::usage, [&] { submit("oleg"); }), not_permitted("operator"));
    }
    options_.listen = service::parse_address("unix:" + folder_.file("other"));
    EXPECT_EQ(error_of(ErrorCode::bad_input, [&] { const service::Server server(options_, silent()); }),
              file + ": line 1: " + lines.back().second);
}

TEST_F(Roles, NamesAndBlanksHaveSeveralSpellings) {
    for (const std::string line : {"token:anna none", "\t token:anna\t none \r", "\"token:anna\"  \"none\""}) {
        write_secret(folder_.file("roles"), "\r\n  \n # all\n" + line + "\n\ntoken:oleg operator");
        server_->reload();
        EXPECT_EQ(error_of(ErrorCode::usage, [&] { (void)client("anna")->list(); }),
                  server_->address().text() + ": the client has no access any more")
            << line;
        EXPECT_EQ(error_of(ErrorCode::usage, [&] { submit("oleg"); }), not_permitted("operator"));
        write_secret(folder_.file("roles"), "");
        server_->reload();
        EXPECT_NO_THROW((void)client("anna")->list());
    }
}

TEST_F(Roles, NamesMayContainQuotesAndBackslashes) {
    write_secret(folder_.file("tokens"), "CORP\\bea bea-0123456789ab\no\"neil oneil-0123456789ab\n");
    for (const std::string line : {"\"token:CORP\\\\bea\" none\n", "token:CORP\\bea none\n"}) {
        write_secret(folder_.file("roles"), line + "\"token:o\\\"neil\" operator\n");
        server_->reload();
        EXPECT_EQ(error_of(ErrorCode::usage, [&] { (void)client("bea")->list(); }),
                  server_->address().text() + ": the client has no access any more");
        EXPECT_EQ(error_of(ErrorCode::usage, [&] { submit("oneil"); }), not_permitted("operator"));
    }
}

TEST_F(Roles, AByteOrderMarkIsRefused) {
    EXPECT_EQ(refusal_of("\xEF\xBB\xBF# who\ntoken:anna none\n"),
              folder_.file("roles") + ": line 1: it begins with a byte order mark; save the file without one");
}

class SceneRoles : public Roles {
protected:
    ClientOptions options_of(const std::string& name) const {
        ClientOptions options{.patience = std::chrono::milliseconds(300), .token = name + "-0123456789ab"};
        return options;
    }
    std::unique_ptr<SceneWatcher> watcher(const std::string& name) const {
        return std::make_unique<SceneWatcher>(server_->address().text(), options_of(name));
    }
    RemoteScene scene(const std::string& name) const {
        RemoteScene scene = connect_scene(server_->address().text(), {}, options_of(name));
        std::vector<ObjectId> ids(boxes_.size());
        scene.add(Objects{boxes_}, ids);
        (void)scene.step();
        return scene;
    }
    static std::optional<SceneSnapshot> look(SceneWatcher& watcher, const std::string& id) {
        return watcher.next(id, 0, std::chrono::seconds(60), 10);
    }
};

TEST_F(SceneRoles, OwnersAndReadersWatchTheScenesOfOneOwner) {
    const RemoteScene of_anna = scene("anna"), of_bert = scene("bert");
    const auto anna = watcher("anna"), bert = watcher("bert"), ruth = watcher("ruth");
    const auto list = anna->list();
    ASSERT_EQ(list.size(), 1u);
    EXPECT_EQ(list[0].owner, "") << "an owner's own scenes";
    const auto read = ruth->list();
    ASSERT_EQ(read.size(), 1u);
    EXPECT_EQ(read[0].id, list[0].id);
    EXPECT_EQ(read[0].owner, "token:anna");
    ASSERT_EQ(bert->list().size(), 1u);
    const std::string other = bert->list()[0].id;
    EXPECT_NE(other, list[0].id);
    EXPECT_TRUE(look(*anna, list[0].id));
    EXPECT_TRUE(look(*ruth, list[0].id));
    for (SceneWatcher* stranger : {anna.get(), ruth.get()}) {
        EXPECT_EQ(error_of(ErrorCode::bad_input, [&] { (void)look(*stranger, other); }), "there is no scene " + other);
    }
}

TEST_F(SceneRoles, OperatorsListAllScenesAndReadNone) {
    const RemoteScene of_anna = scene("anna"), of_bert = scene("bert");
    const auto oleg = watcher("oleg");
    const auto list = oleg->list();
    ASSERT_EQ(list.size(), 2u);
    EXPECT_LT(list[0].id, list[1].id);
    EXPECT_EQ(std::set({list[0].owner, list[1].owner}), std::set<std::string>({"token:anna", "token:bert"}));
    EXPECT_EQ(error_of(ErrorCode::usage, [&] { (void)look(*oleg, list[0].id); }), not_permitted("operator"));
}

TEST_F(SceneRoles, StrangersSeeNoScenes) {
    const RemoteScene of_anna = scene("anna");
    const std::string id = watcher("anna")->list().at(0).id;
    const auto stranger = watcher("nobody");
    const std::string refusal = server_->address().text() + ": the server does not accept this token";
    EXPECT_EQ(error_of(ErrorCode::usage, [&] { (void)stranger->list(); }), refusal);
    EXPECT_EQ(error_of(ErrorCode::usage, [&] { (void)look(*stranger, id); }), refusal);
}

class TokenLines : public Roles {
protected:
    /// Returns whether the server accepts anna's token with this line.
    bool accepts(const std::string& line) const {
        write_secret(folder_.file("tokens"), line + "\n");
        server_->reload();
        try {
            (void)client("anna")->list();
            return true;
        } catch (const Error&) {
            return false;
        }
    }
    std::string wrong(const std::string& line) const {
        write_secret(folder_.file("tokens"), line + "\n");
        return error_of(ErrorCode::bad_input, [&] { server_->reload(); });
    }
};

TEST_F(TokenLines, MayHoldHashes) {
    // printf anna-0123456789ab | sha256sum
    const std::string hash = "ec5f5bd74fe6158aa9084539e49b1dc8564f45d7cb2fb548090013acd3b643eb";
    EXPECT_TRUE(accepts("anna anna-0123456789ab"));
    EXPECT_TRUE(accepts("anna sha256:" + hash));
    EXPECT_FALSE(accepts("anna sha256:" + std::string(hash.rbegin(), hash.rend())));
    const std::string file = folder_.file("tokens");
    EXPECT_EQ(wrong("anna sha256:12"), file + ": line 1: sha256: must be followed by 64 hexadecimal digits");
    EXPECT_EQ(wrong("anna sha256:" + std::string(64, 'x')),
              file + ": line 1: sha256: must be followed by 64 hexadecimal digits");
}

/// A line that would let in nobody, or somebody else, is an error.
TEST_F(TokenLines, ThatAreNearlyRightAreRefused) {
    const std::string hash = "ec5f5bd74fe6158aa9084539e49b1dc8564f45d7cb2fb548090013acd3b643eb";
    const std::string begin = folder_.file("tokens") + ": line 1: ";
    for (const std::string name : {"SHA256:", "Sha256:", "sha-256:", "sha512:", "SHA256=", "sha256=", "md5:", "sha256$",
                                   "sha256", "sha256-", "sha256;", "sha256a"})
        EXPECT_EQ(wrong("anna " + name + hash), begin + "a hash must be written as sha256: and 64 hexadecimal digits")
            << name;
    for (const std::string name : {"token:anna", "\357\273\277anna", "an\1na"})
        EXPECT_EQ(wrong(name + " anna-0123456789ab").find(begin + "a name "), 0u) << name;
    EXPECT_EQ(wrong("anna\vanna-0123456789ab"),
              begin + "a name has no control characters, and no byte order mark before it");
    EXPECT_EQ(wrong("anna anna-0123456789ab\funtil=2099-12-31"),
              begin + "a token must consist of printable ASCII characters");
    for (const std::string end : {"UNTIL=2099-12-31", "until=2099-12-31 x", "2099-12-31"})
        EXPECT_EQ(wrong("anna anna-0123456789ab " + end),
                  begin + "a line must be NAME TOKEN, or NAME TOKEN until=TIME");
    write_secret(folder_.file("tokens"),
                 "anna anna-0123456789ab\nberta shared-key:0123456789\nclara ShaBx0123456789abcdef=\n");
    server_->reload();
    EXPECT_EQ(wrong("anna anna-0123456789\303\244b"), begin + "a token must consist of printable ASCII characters");
    EXPECT_TRUE(accepts("anna anna-0123456789ab"));
}

TEST_F(TokenLines, MayExpire) {
    EXPECT_TRUE(accepts("anna anna-0123456789ab until=2099-12-31"));
    EXPECT_TRUE(accepts("anna anna-0123456789ab until=2099-12-31T23:59:59Z"));
    EXPECT_TRUE(accepts("anna anna-0123456789ab until=9999-12-31"));
    EXPECT_TRUE(accepts("anna anna-0123456789ab until=2262-05-01T00:00:00Z"));
    EXPECT_FALSE(accepts("anna anna-0123456789ab until=2020-02-29"));
    // The nanoseconds of these years are beyond 64 bits, and without their high bits in this century.
    for (const char* year : {"0000", "0900", "1027", "1442", "1527", "1677", "1969"})
        EXPECT_FALSE(accepts("anna anna-0123456789ab until=" + std::string(year) + "-12-31")) << year;
    EXPECT_FALSE(accepts("anna anna-0123456789ab until=2020-02-29T12:00:00Z"));
    const std::string file = folder_.file("tokens");
    for (const char* time : {"tomorrow",
                             "2099-13-01",
                             "2099-01-01T12:00",
                             "2099-01-01 12:00",
                             "2030-02-31",
                             "2030-02-29",
                             "2030-04-31",
                             "2030-00-01",
                             "2030-01-00",
                             "2030-1-5",
                             "2030-01-5",
                             "20300-01-05",
                             "02030-01-05",
                             "2030-01-32",
                             "2030/01/05",
                             "+030-01-05",
                             "2030-01-05T24:00:00Z",
                             "2030-01-05T23:60:00Z",
                             "2030-01-05T23:59:60Z",
                             "2030-01-05T23:59:59",
                             "2030-01-05T23:59:59z",
                             "2030-01-05T23:59:59+00:00",
                             "2030-01-05T1:00:00Z",
                             "2030-01-05Z",
                             "2030-01-05x",
                             ""})
        EXPECT_TRUE(has_text(wrong("anna anna-0123456789ab until=" + std::string(time)), file + ": line 1: "));
}

TEST_F(TokenLines, ExpireWhenTheirDayEnds) {
    const std::time_t now = std::time(nullptr);
    const auto day = [&](int from_today) {
        const std::time_t time = now + from_today * 24 * 3600;
        std::tm parts{};
        ::gmtime_r(&time, &parts);
        char text[32];
        (void)std::strftime(text, sizeof text, "%Y-%m-%d", &parts);
        return std::string(text);
    };
    EXPECT_FALSE(accepts("anna anna-0123456789ab until=" + day(-1)));
    EXPECT_TRUE(accepts("anna anna-0123456789ab until=" + day(1)));
    const bool today = accepts("anna anna-0123456789ab until=" + day(0));
    EXPECT_TRUE(today || std::time(nullptr) / (24 * 3600) > now / (24 * 3600));
}

}  // namespace
}  // namespace octopair::test
