#include "service/server/log/metrics.hpp"

#include <arpa/inet.h>
#include <netdb.h>
#include <prometheus/counter.h>
#include <prometheus/exposer.h>
#include <prometheus/gauge.h>
#include <prometheus/histogram.h>
#include <prometheus/registry.h>

#include <array>
#include <exception>
#include <map>
#include <mutex>
#include <utility>

#include "octopair/error.hpp"
#include "service/protocol/octopair.pb.h"

namespace octopair::service {

namespace {

using prometheus::Counter;
using prometheus::Family;
using prometheus::Gauge;

/// Names of the states before the end, indexed by v1::JobState.
constexpr std::array<const char*, 3> states = {"uploading", "queued", "running"};
constexpr std::array<const char*, 3> outcomes = {"done", "failed", "cancelled"};
constexpr std::array<const char*, 4> steps = {"encode", "count", "scatter", "scan"};

/// Returns the address with a numeric host, because civetweb does not resolve names.
std::string numeric(const Address& address) {
    if (address.is_unix()) throw Error(ErrorCode::usage, address.text() + ": metrics need HOST:PORT");
    if (!is_this_machine(address)) {
        throw Error(ErrorCode::usage,
                    address.text() + ": metrics are shown on this machine alone (127.0.0.1, ::1, localhost)");
    }
    in6_addr number{};
    Address found = address;
    if (address.host.find(':') == std::string::npos && ::inet_pton(AF_INET, address.host.c_str(), &number) != 1) {
        found.host = "127.0.0.1";
    }
    return found.text();
}

}  // namespace

struct Metrics::Store {
    prometheus::Registry registry;

    std::array<Gauge*, 3> jobs = all(gauges("octopair_jobs", "Jobs that have not ended, by state"), "state", states);
    std::array<Counter*, 3> ended =
        all(counters("octopair_jobs_ended_total", "Jobs that have ended, by outcome"), "outcome", outcomes);
    prometheus::Histogram& seconds =
        prometheus::BuildHistogram()
            .Name("octopair_job_seconds")
            .Help("Seconds that jobs ran")
            .Register(registry)
            .Add({}, std::vector<double>{0.001, 0.003, 0.01, 0.03, 0.1, 0.3, 1, 3, 10, 30, 100, 300});
    prometheus::Histogram& queue_seconds =
        prometheus::BuildHistogram()
            .Name("octopair_queue_seconds")
            .Help("Seconds that jobs waited for an engine")
            .Register(registry)
            .Add({}, std::vector<double>{0.001, 0.003, 0.01, 0.03, 0.1, 0.3, 1, 3, 10, 30, 100, 300});
    std::array<Counter*, 4> step_seconds =
        all(counters("octopair_step_seconds_total", "Seconds that jobs took, by step"), "step", steps);
    Counter& received = counters("octopair_received_bytes_total", "Bytes of jobs received").Add({});
    Counter& sent = counters("octopair_sent_bytes_total", "Bytes of results sent").Add({});
    Family<Counter>& refusals = counters("octopair_refusals_total", "Refusals, by limit");
    Family<Counter>& call_refusals = counters("octopair_calls_refused_total", "Calls refused, by reason");

    /// Counters of one client.
    struct Client {
        Counter &jobs, &seconds, &bytes, &pairs, &refusals;
    };
    Client& client(const std::string& name) {
        constexpr std::size_t most_clients = 50;
        const std::lock_guard lock(clients_mutex_);
        const bool named = clients_.contains(name) || clients_.size() < most_clients;
        const std::string label = named ? name : "other";
        const auto known = clients_.find(label);
        if (known != clients_.end()) return known->second;
        const auto add = [&](Family<Counter>& family) -> Counter& { return family.Add({{"client", label}}); };
        return clients_
            .emplace(label, Client{add(client_jobs_), add(client_seconds_), add(client_bytes_), add(client_pairs_),
                                   add(client_refusals_)})
            .first->second;
    }

    Gauge& queue = gauges("octopair_queue_length", "Jobs that wait for an engine").Add({});
    Gauge& connections = gauges("octopair_connections", "Open connections").Add({});
    Gauge& memory = gauges("octopair_memory_bytes", "Memory reserved for jobs, limited by --max-memory").Add({});
    Counter& connections_refused = refusals.Add({{"limit", "connections"}});
    Counter& worker_faults = counters("octopair_worker_faults_total", "Worker processes that were lost").Add({});

    std::shared_ptr<prometheus::Collectable> collector;
    std::unique_ptr<prometheus::Exposer> exposer;

private:
    Family<Gauge>& gauges(const char* name, const char* help) {
        return prometheus::BuildGauge().Name(name).Help(help).Register(registry);
    }
    Family<Counter>& counters(const char* name, const char* help) {
        return prometheus::BuildCounter().Name(name).Help(help).Register(registry);
    }
    Family<Counter>& client_jobs_ = counters("octopair_client_jobs_total", "Jobs that have ended, by client");
    Family<Counter>& client_seconds_ =
        counters("octopair_client_job_seconds_total", "Seconds that jobs ran, by client");
    Family<Counter>& client_bytes_ = counters("octopair_client_input_bytes_total", "Bytes of ended jobs, by client");
    Family<Counter>& client_pairs_ = counters("octopair_client_pairs_total", "Pairs of ended jobs, by client");
    Family<Counter>& client_refusals_ =
        counters("octopair_client_refusals_total", "Requests beyond a limit, by client");
    std::mutex clients_mutex_;
    std::map<std::string, Client> clients_;

    template <typename Metric, std::size_t n>
    static std::array<Metric*, n> all(Family<Metric>& family, const char* label,
                                      const std::array<const char*, n>& values) {
        std::array<Metric*, n> made{};
        for (std::size_t i = 0; i < n; ++i) made[i] = &family.Add({{label, values[i]}});
        return made;
    }
};

/// Collects the metrics for an HTTP request.
class Metrics::Collector final : public prometheus::Collectable {
public:
    Collector(Store& store, std::function<Levels()> levels) : store_(store), levels_(std::move(levels)) {}

    std::vector<prometheus::MetricFamily> Collect() const override {
        const std::lock_guard lock(mutex_);
        const Levels now = levels_();
        store_.queue.Set(double(now.queue));
        store_.connections.Set(double(now.connections));
        store_.memory.Set(double(now.memory_bytes));
        catch_up(store_.connections_refused, now.connections_refused);
        catch_up(store_.worker_faults, now.worker_faults);
        return store_.registry.Collect();
    }

private:
    static void catch_up(Counter& counter, std::uint64_t value) { counter.Increment(double(value) - counter.Value()); }

    Store& store_;
    const std::function<Levels()> levels_;
    mutable std::mutex mutex_;
};

Metrics::Metrics() : store_(std::make_unique<Store>()) {}

Metrics::~Metrics() { hide(); }

void Metrics::job_state_changed(std::optional<v1::JobState> from, v1::JobState to) {
    if (from && *from < v1::DONE) store_->jobs.at(std::size_t(*from))->Decrement();
    if (to < v1::DONE)
        store_->jobs.at(std::size_t(to))->Increment();
    else
        store_->ended.at(std::size_t(to - v1::DONE))->Increment();
}

void Metrics::job_ended(const v1::JobReport& report, double seconds) {
    if (seconds > 0) store_->seconds.Observe(seconds);
    if (!report.failure().limit().empty()) refused(report.failure().limit());
    const v1::Summary& summary = report.summary();
    const std::array<double, 4> taken = {summary.encode_seconds(), summary.count_seconds(), summary.scatter_seconds(),
                                         summary.scan_seconds()};
    for (std::size_t i = 0; i < taken.size(); ++i) store_->step_seconds.at(i)->Increment(taken.at(i));
}

void Metrics::job_started(double queue_seconds) { store_->queue_seconds.Observe(queue_seconds); }

void Metrics::client_job_ended(const std::string& client, const ClientJob& job) {
    Store::Client& counters = store_->client(client);
    counters.jobs.Increment();
    counters.seconds.Increment(job.seconds);
    counters.bytes.Increment(double(job.bytes));
    counters.pairs.Increment(double(job.pairs));
}

void Metrics::client_refused(const std::string& client) { store_->client(client).refusals.Increment(); }
void Metrics::refused(const std::string& limit) { store_->refusals.Add({{"limit", limit}}).Increment(); }
void Metrics::call_refused(const std::string& reason) { store_->call_refusals.Add({{"reason", reason}}).Increment(); }
void Metrics::received(std::uint64_t bytes) { store_->received.Increment(double(bytes)); }
void Metrics::sent(std::uint64_t bytes) { store_->sent.Increment(double(bytes)); }

int Metrics::show(const Address& address, std::function<Levels()> levels) {
    const std::string where = numeric(address);
    try {
        // Each connection has a thread of its own for at most 2 s, so connections that send nothing do not delay other connections.
        store_->exposer = std::make_unique<prometheus::Exposer>(
            std::vector<std::string>{"listening_ports", where, "num_threads", "16", "request_timeout_ms", "2000"});
    } catch (const std::exception&) {  // an exception of civetweb, which gives no reason
        throw Error(ErrorCode::io_failed, address.text() + ": cannot show metrics there; the address may be taken");
    }
    store_->collector = std::make_shared<Collector>(*store_, std::move(levels));
    store_->exposer->RegisterCollectable(store_->collector);
    return store_->exposer->GetListeningPorts().front();
}

void Metrics::hide() {
    store_->exposer.reset();
    store_->collector.reset();
}

}  // namespace octopair::service
