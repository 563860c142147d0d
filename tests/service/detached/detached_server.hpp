// A server with a state folder in the test's process, on a Unix socket. The folder outlives the server.
#pragma once

#include <gtest/gtest.h>
#include <spdlog/logger.h>
#include <spdlog/sinks/ostream_sink.h>

#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "io/temporary.hpp"
#include "octopair/job_client.hpp"
#include "octopair/octopair.hpp"
#include "service/server/server.hpp"
#include "support/calls.hpp"
#include "support/compare.hpp"
#include "support/kinds.hpp"

namespace octopair::test {

class DetachedServer {
public:
    using Change = std::function<void(service::ServerOptions&)>;

    explicit DetachedServer(const Change& change = {}) {
        options_.listen = service::parse_address(address());
        options_.engine = [](unsigned width) { return make_local_engine(width); };
        options_.engine_name = "local";
        options_.engine_widths = {2, 2, 2};
        options_.state_folder = state();
        if (change) change(options_);
        start();
    }

    std::string address() const { return "unix:" + folder_.file("socket"); }
    std::string state() const { return folder_.file("state"); }
    const TemporaryDirectory& folder() const { return folder_; }
    service::ServerOptions& options() { return options_; }
    std::string log() const { return words_.str(); }
    const std::ostringstream& words() const { return words_; }

    void start() {
        const auto log =
            std::make_shared<spdlog::logger>("test", std::make_shared<spdlog::sinks::ostream_sink_mt>(words_));
        server_ = std::make_unique<service::Server>(options_, log);
    }
    void drain() { server_->drain(); }
    void stop() { server_.reset(); }
    void restart() {
        stop();
        start();
    }

    std::unique_ptr<JobClient> client(const std::string& token = {}) const {
        ClientOptions options{.patience = std::chrono::seconds(30), .token = token};
        return std::make_unique<JobClient>(address(), options);
    }

    /// Returns the files of jobs in the state folder whose names end with `ending`.
    std::vector<std::string> files(const std::string& ending = {}) const {
        std::vector<std::string> names;
        for (const auto& entry : std::filesystem::directory_iterator(state())) {
            const std::string name = entry.path().filename().string();
            if (name != "lock" && name != "version" && name.ends_with(ending)) names.push_back(entry.path().string());
        }
        return names;
    }

private:
    TemporaryDirectory folder_;
    service::ServerOptions options_;
    std::ostringstream words_;
    std::unique_ptr<service::Server> server_;
};

/// Returns whether the condition holds within a minute.
inline bool comes_true(const std::function<bool()>& condition) {
    for (int i = 0; i < 6000; ++i) {
        if (condition()) return true;
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    return false;
}

/// The input of a submitted job.
struct Work {
    Objects first;
    std::optional<Objects> second;
    Options options;
    JobTerms terms;

    explicit Work(const Objects& objects) : first(objects) {}
    Work(const Objects& one, const Objects& other) : first(one), second(other) {}
    Work(const Objects& objects, Options asked) : first(objects), options(std::move(asked)) {}
};

inline std::string submit(JobClient& client, const Work& work) {
    return client.submit({work.first, work.second}, work.options, work.terms);
}

inline std::vector<Pair> pairs_here(const Work& work) {
    return listed_pairs(*make_local_engine(1), {work.first, work.second}, work.options);
}

inline std::vector<Pair> pairs_there(JobClient& client, const std::string& id) {
    PairList pairs;
    const Summary summary = client.result(id, pairs);
    EXPECT_EQ(summary.pairs, pairs.size());
    return pairs.to_vector();
}

/// Expects that a job ends within five minutes, and has a result.
inline void expect_done(JobClient& client, const std::string& id) {
    EXPECT_EQ(int(client.wait(id, std::chrono::minutes(5)).state), int(JobState::done));
}

/// Expects that a job fails within five minutes. Returns the message of its error.
inline std::string failure_of(JobClient& client, const std::string& id, ErrorCode code) {
    const JobStatus status = client.wait(id, std::chrono::minutes(5));
    EXPECT_EQ(int(status.state), int(JobState::failed));
    EXPECT_EQ(int(status.error.value().code()), int(code)) << status.error->what();
    return status.error->what();
}

/// Expects that a job has the pairs that the local engine finds.
inline void expect_result(JobClient& client, const std::string& id, const Work& work) {
    EXPECT_TRUE(same_bytes(pairs_there(client, id), pairs_here(work)));
}

/// Submits a job, and expects its result.
inline void expect_served(JobClient& client, const Work& work) { expect_result(client, submit(client, work), work); }

/// A test with its own server and a client.
class DetachedTest : public ::testing::Test {
protected:
    DetachedServer server_;
    const std::unique_ptr<JobClient> client_ = server_.client();
};

inline const std::string some_id = "01234567-89ab-cdef-0123-456789abcdef";

}  // namespace octopair::test
