// Tests the lines of a server's log.
#include <spdlog/sinks/ostream_sink.h>

#include <nlohmann/json.hpp>
#include <sstream>
#include <thread>

#include "service/guarded.hpp"

namespace octopair::test {
namespace {

using nlohmann::json;
using service::LogForm;

class Log : public ::testing::Test {
protected:
    std::shared_ptr<spdlog::logger> log(LogForm form) {
        return service::make_log(form, std::make_shared<spdlog::sinks::ostream_sink_mt>(text_));
    }
    std::vector<std::string> lines() const {
        std::istringstream in(text_.str());
        std::vector<std::string> lines;
        for (std::string line; std::getline(in, line);) lines.push_back(line);
        return lines;
    }
    /// Waits for an event with the given message, for a minute at most. Returns the event, or null.
    json event(const std::string& message) const {
        const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(60);
        while (std::chrono::steady_clock::now() < end) {
            for (const std::string& line : lines()) {
                json found = json::parse(line, nullptr, false);
                if (!found.is_discarded() && found["message"] == message) return found;
            }
            std::this_thread::sleep_for(std::chrono::milliseconds(20));
        }
        return json();
    }

    TemporaryDirectory folder_;
    std::ostringstream text_;
};

TEST_F(Log, EventsAreLinesForPeople) {
    const auto logger = log(LogForm::text);
    service::log_line(
        *logger, service::LogLevel::info, "job ended",
        {{"id", "x"}, {"reason", "two words"}, {"pairs", std::uint64_t(12)}, {"seconds", 0.5}, {"no", ""}});
    logger->warn("else {}", 3);
    ASSERT_EQ(lines().size(), 2u);
    EXPECT_EQ(lines()[0].substr(24), " info job ended id=x reason=\"two words\" pairs=12 seconds=0.5 no=\"\"");
    EXPECT_EQ(lines()[1].substr(24), " warning else 3");
    EXPECT_EQ(lines()[0][10], 'T');
    EXPECT_EQ(lines()[0][23], 'Z');
}

TEST_F(Log, EventsAreObjectsForPrograms) {
    const auto logger = log(LogForm::json);
    const std::string nasty = "a\"b\\c\nd\x1f\xff \xc3\xa9";
    service::log_line(*logger, service::LogLevel::warning, "refused",
                      {{"owner", nasty}, {"allowed", std::uint64_t(7)}});
    logger->info("plain {}", nasty);
    ASSERT_EQ(lines().size(), 2u) << text_.str();
    const json first = json::parse(lines()[0]), second = json::parse(lines()[1]);
    EXPECT_EQ(first["message"], "refused");
    EXPECT_EQ(first["level"], "warning");
    EXPECT_EQ(first["owner"], "a\"b\\c?d?\xef\xbf\xbd \xc3\xa9");
    EXPECT_EQ(first["allowed"], 7);
    EXPECT_EQ(second["level"], "info");
    EXPECT_TRUE(second["message"].get<std::string>().starts_with("plain a\"b\\c?d"));
}

TEST_F(Log, TellsOfJobsAndRefusalsButNoToken) {
    write_secret(folder_.file("tokens"), "anna 0123456789abcdef\n");
    service::ServerOptions options = options_at("unix:" + folder_.file("socket"));
    options.token_file = folder_.file("tokens");
    options.limits.objects = 3;
    const auto logger = log(LogForm::json);
    logger->set_level(spdlog::level::debug);  // jobs of one message are logged at this level
    const service::Server server(options, logger);
    const std::string address = server.address().text();
    ClientOptions client{.token = "0123456789abcdef"};
    EXPECT_EQ(ask(address, client), right_answer);
    const json ended = event("job ended");
    EXPECT_EQ(ended["owner"], "token:anna");
    EXPECT_EQ(ended["objects"], 3);
    EXPECT_EQ(ended["pairs"], 1);
    EXPECT_EQ(ended["outcome"], "done");
    EXPECT_EQ(ended["level"], "debug");
    EXPECT_TRUE(ended["seconds"].is_number());

    PairList pairs;
    const std::vector<Box3f> four(4);
    EXPECT_NE(error_of(ErrorCode::resource_limit, [&] { connect(address, client)->find_pairs({four}, pairs); }), "");
    const json refused = event("refused");
    EXPECT_EQ(refused["limit"], "objects");
    EXPECT_EQ(refused["allowed"], 3);
    EXPECT_EQ(refused["owner"], "token:anna");

    client.token = "not the right token";
    EXPECT_NE(error_of(ErrorCode::usage, [&] { ask(address, client); }), "");
    EXPECT_EQ(event("call refused")["reason"], "the server does not accept this token");
    EXPECT_FALSE(has_text(text_.str(), "0123456789abcdef"));
    EXPECT_FALSE(has_text(text_.str(), "not the right token"));
}

TEST_F(Log, RefusedCallsDoNotFillTheLog) {
    write_secret(folder_.file("tokens"), "anna 0123456789abcdef\n");
    service::ServerOptions options = options_at("unix:" + folder_.file("socket"));
    options.token_file = folder_.file("tokens");
    const auto logger = log(LogForm::json);
    const service::Server server(options, logger);
    const auto call = [&] { (void)call_raw(server.address().text(), "/octopair.v1.Octopair/Describe"); };
    const auto begin = std::chrono::steady_clock::now();
    for (int i = 0; i < 50; ++i) call();
    const auto seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    std::this_thread::sleep_for(std::chrono::milliseconds(1100));
    call();
    std::istringstream lines(text_.str());
    std::size_t refused = 0, unreported = 0;
    for (std::string line; std::getline(lines, line);) {
        const json read = json::parse(line);
        if (read["message"] != "call refused") continue;
        ++refused;
        unreported += read.value("unreported", std::size_t(0));
    }
    EXPECT_LE(refused, 2 + std::size_t(seconds));
    EXPECT_EQ(refused + unreported, 51u);
}

}  // namespace
}  // namespace octopair::test
