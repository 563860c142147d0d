#include "service/served.hpp"

#include <gtest/gtest.h>
#include <spdlog/logger.h>
#include <spdlog/sinks/null_sink.h>

#include "octopair/error.hpp"
#include "processes/leftovers.hpp"

namespace octopair::test {

namespace {

std::shared_ptr<spdlog::logger> silent_log() {
    return std::make_shared<spdlog::logger>("test", std::make_shared<spdlog::sinks::null_sink_mt>());
}

}  // namespace

Served::Served(const Change& change) {
    options_.listen = service::parse_address("unix:" + folder_.file("socket"));
    options_.engine = [](unsigned width) { return make_local_engine(width); };
    options_.engine_name = "local";
    options_.engine_widths = {2, 2, 2};
    if (change) change(options_);
    start();
}

void Served::start() {
    server_ = std::make_unique<service::Server>(options_, silent_log());
    address_ = server_->address().text();
}

bool Served::comes_to_rest() const {
    return comes_true([&] { return load().jobs == 0 && load().memory_bytes == 0; }, std::chrono::minutes(1));
}

std::unique_ptr<Engine> Served::client(std::chrono::milliseconds patience) const {
    return connect(address_, {.patience = patience});
}

void check_serves(const std::string& address) {
    const std::vector<Box3f> boxes = {{{0, 0, 0}, {1, 1, 1}}, {{1, 1, 1}, {2, 2, 2}}, {{5, 5, 5}, {6, 6, 6}}};
    PairList pairs;
    (void)connect(address, {.patience = std::chrono::seconds(60)})->find_pairs({boxes}, pairs);
    EXPECT_EQ(pairs.to_vector(), (std::vector<Pair>{{0, 1}}));
}

void expect_refused(const std::string& limit, std::uint64_t allowed, const std::function<void()>& call) {
    const std::string words = error_of(ErrorCode::resource_limit, call);
    EXPECT_TRUE(has_text(words, limit));
    EXPECT_TRUE(has_text(words, std::to_string(allowed)));
}

}  // namespace octopair::test
