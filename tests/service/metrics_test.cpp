// Tests the metrics that a server exports to Prometheus.
#include <nlohmann/json.hpp>
#include <regex>
#include <set>

#include "service/metrics_page.hpp"
#include "support/scale.hpp"

namespace octopair::test {
namespace {

class Metrics : public ::testing::Test {
protected:
    std::string socket() const { return "unix:" + folder_.file("socket"); }

    service::Server& serve(service::ServerOptions options) {
        options.metrics = service::parse_address("localhost:0");
        server_ = std::make_unique<service::Server>(options, log_to(log_));
        return *server_;
    }

    ::testing::AssertionResult comes(const std::string& line) const { return page_has(log_, line); }
    std::string page() const { return metrics_page(log_.str()); }

    TemporaryDirectory folder_;
    std::ostringstream log_;
    std::unique_ptr<service::Server> server_;
};

TEST_F(Metrics, CountJobs) {
    serve(options_at(socket()));
    EXPECT_TRUE(comes("octopair_jobs_ended_total{outcome=\"done\"} 0"));
    EXPECT_EQ(ask(socket(), {}), right_answer);
    EXPECT_TRUE(comes("octopair_jobs_ended_total{outcome=\"done\"} 1"));
    EXPECT_TRUE(comes("octopair_job_seconds_count 1"));
    for (const std::string state : {"uploading", "queued", "running"}) {
        EXPECT_TRUE(comes("octopair_jobs{state=\"" + state + "\"} 0"));
    }
    EXPECT_TRUE(comes("octopair_memory_bytes 0"));
    EXPECT_TRUE(comes("octopair_queue_length 0"));
    EXPECT_TRUE(comes("octopair_connections 0"));
    for (const std::string direction : {"received", "sent"}) {
        EXPECT_FALSE(has_text(page(), "octopair_" + direction + "_bytes_total 0\n"));
    }
}

/// A result that does not fit into a message is computed twice, the first time incompletely. The next job of similar
/// size is computed once.
TEST_F(Metrics, TellOfResultsThatDoNotFitIntoAMessage) {
    serve(options_at(socket()));
    const auto client = connect(socket());
    const std::vector<Box3f> crowd(scaled(8000, 2));
    for (const char* const done : {"1", "2"}) {
        std::uint64_t pairs = 0;
        const PairSink count = [&](std::span<const Pair> some) { pairs += some.size(); };
        (void)client->stream_pairs({crowd}, count, {.order = Order::octal});
        EXPECT_EQ(pairs, crowd.size() * (crowd.size() - 1) / 2);
        EXPECT_TRUE(comes(std::string("octopair_jobs_ended_total{outcome=\"done\"} ") + done));
        EXPECT_TRUE(comes("octopair_jobs_ended_total{outcome=\"cancelled\"} 1"));
    }
    EXPECT_EQ(client->count_pairs({crowd}), crowd.size() * (crowd.size() - 1) / 2);
}

TEST_F(Metrics, CountByClient) {
    service::ServerOptions options = options_at(socket());
    std::string tokens;
    for (int i = 0; i < 60; ++i)
        tokens += "client" + std::to_string(i) + " 0123456789abcde-" + std::to_string(i) + "\n";
    write_secret(folder_.file("tokens"), tokens);
    options.token_file = folder_.file("tokens");
    options.limits.objects = 10;
    serve(options);
    for (int i = 0; i < 60; ++i)
        EXPECT_EQ(ask(socket(), {.token = "0123456789abcde-" + std::to_string(i)}), right_answer);
    EXPECT_TRUE(comes("octopair_client_jobs_total{client=\"token:client0\"} 1"));
    EXPECT_TRUE(comes("octopair_client_pairs_total{client=\"token:client49\"} 1"));
    EXPECT_TRUE(comes("octopair_client_input_bytes_total{client=\"token:client49\"} 72"));
    EXPECT_TRUE(comes("octopair_client_jobs_total{client=\"other\"} 10")) << "labels are bounded";
    EXPECT_TRUE(comes("octopair_queue_seconds_count 60"));
    const std::vector<Box3f> many(11);
    (void)error_of(ErrorCode::resource_limit,
                   [&] { (void)connect(socket(), {.token = "0123456789abcde-0"})->count_pairs({many}); });
    EXPECT_TRUE(comes("octopair_client_refusals_total{client=\"token:client0\"} 1"));
}

/// The dashboard shows each metric, and no other.
TEST_F(Metrics, AreAllOnTheDashboard) {
    service::ServerOptions options = options_at(socket());
    write_secret(folder_.file("tokens"), "anna 0123456789abcdef\n");
    options.token_file = folder_.file("tokens");
    serve(options);
    EXPECT_EQ(ask(socket(), {.token = "0123456789abcdef"}), right_answer);
    (void)error_of(ErrorCode::usage, [&] { ask(socket(), {}); });
    EXPECT_TRUE(comes("octopair_client_jobs_total{client=\"token:anna\"} 1"));
    const std::string dashboard = read_file(OCTOPAIR_SOURCE "/packaging/grafana.json"), page = this->page();
    EXPECT_FALSE(nlohmann::json::parse(dashboard, nullptr, false).is_discarded());
    std::set<std::string> shown, served;
    const std::regex name("octopair_[a-z_]+"), described("# TYPE (octopair_[a-z_]+)");
    for (std::sregex_iterator at(dashboard.begin(), dashboard.end(), name), end; at != end; ++at)
        shown.insert(std::regex_replace(at->str(), std::regex("_bucket$"), ""));
    for (std::sregex_iterator at(page.begin(), page.end(), described), end; at != end; ++at) served.insert((*at)[1]);
    EXPECT_EQ(shown, served);
}

TEST_F(Metrics, AreNotBlockedByIdleConnections) {
    serve(options_at(socket()));
    std::vector<Descriptor> idle;
    for (int i = 0; i < 8; ++i) idle.push_back(connect_to_metrics(log_.str()));
    EXPECT_TRUE(idle.back().open());
    const auto begun = std::chrono::steady_clock::now();
    EXPECT_TRUE(has_text(page(), "octopair_memory_bytes"));
    EXPECT_LT(std::chrono::steady_clock::now() - begun, std::chrono::seconds(10)) << "an idle connection lasts 30 s";
}

TEST_F(Metrics, CountRefusals) {
    service::ServerOptions options = options_at(socket());
    options.limits.objects = 2;
    serve(options);
    EXPECT_NE(error_of(ErrorCode::resource_limit, [&] { ask(socket(), {}); }), "");
    EXPECT_TRUE(comes("octopair_refusals_total{limit=\"objects\"} 1"));
    EXPECT_TRUE(comes("octopair_refusals_total{limit=\"connections\"} 0"));
}

TEST_F(Metrics, CountCallsThatAreNotLetIn) {
    write_secret(folder_.file("tokens"), "anna 0123456789abcdef\n");
    service::ServerOptions options = options_at(socket());
    options.token_file = folder_.file("tokens");
    serve(options);
    EXPECT_EQ(call_raw(socket(), "/octopair.v1.Octopair/Describe").error_code(), grpc::StatusCode::UNAUTHENTICATED);
    EXPECT_TRUE(comes("octopair_calls_refused_total{reason=\"unauthenticated\"} 1"));
}

TEST_F(Metrics, AreShownOnThisMachineAlone) {
    service::ServerOptions options = options_at(socket());
    options.metrics = service::parse_address("0.0.0.0:0");
    EXPECT_EQ(error_of(ErrorCode::usage, [&] { const service::Server server(options, silent()); }),
              "0.0.0.0:0: metrics are shown on this machine alone (127.0.0.1, ::1, localhost)");
}

}  // namespace
}  // namespace octopair::test
