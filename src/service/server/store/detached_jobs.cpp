#include "service/server/store/detached_jobs.hpp"

#include <algorithm>
#include <optional>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include "base/memory.hpp"
#include "octopair/error.hpp"
#include "service/protocol/errors.hpp"
#include "service/protocol/job_hash.hpp"
#include "service/protocol/job_spec.hpp"
#include "service/protocol/status.hpp"
#include "service/server/log/log_line.hpp"
#include "service/server/store/file.hpp"

namespace octopair::service {

namespace {

/// Returns the report of a job that cannot run: its files are damaged, or it exceeds the limits of this server.
v1::JobReport report_of(const StoredSpec& stored, const Error& damage) {
    v1::JobReport report;
    report.set_state(v1::FAILED);
    report.mutable_head()->set_hash(stored.hash);
    report.mutable_head()->set_algorithm(stored.algorithm);
    *report.mutable_failure() = failure_of(damage);
    return report;
}

/// Removes older jobs with the owner and id of a later one. They exist if a job was released and submitted again, and the
/// server ended before the old files were deleted.
void remove_superseded(std::vector<StateFolder::Found>& jobs) {
    std::set<std::pair<std::string, std::string>> names;
    const auto is_superseded = [&](const StateFolder::Found& found) {
        return !names.emplace(found.stored.owner, found.stored.spec.id()).second;
    };
    std::reverse(jobs.begin(), jobs.end());
    const auto kept =
        std::stable_partition(jobs.begin(), jobs.end(), [&](const auto& found) { return !is_superseded(found); });
    for (auto superseded = kept; superseded != jobs.end(); ++superseded) {
        remove_file(superseded->base + ".job");
        remove_file(superseded->base + ".result");
    }
    if (kept != jobs.end()) (void)sync_folder_of(kept->base);
    jobs.erase(kept, jobs.end());
    std::reverse(jobs.begin(), jobs.end());
}

/// Copies the job file `from` to `to`, with the algorithm version and the hash of this program. Returns the spec that was written.
StoredSpec rewrite(const File& from, const File& to, const StoredSpec& old) {
    StoredSpec fresh = old;
    fresh.algorithm = algorithm_version;
    const std::string block = encode_block(fresh);
    fresh.input_at = block.size();
    const std::uint64_t bytes = input_bytes(old.spec);
    to.reserve(job_file_bytes(block, bytes));
    to.write(0, std::as_bytes(std::span(block)));
    JobHash old_hash(old.spec, old.algorithm), fresh_hash(old.spec);
    Buffer<std::byte> piece(piece_bytes);
    for (std::uint64_t done = 0; done < bytes;) {
        const auto part = piece.span().first(std::size_t(std::min<std::uint64_t>(bytes - done, piece.size())));
        from.read(old.input_at + done, part);
        old_hash.add(part);
        fresh_hash.add(part);
        to.write(fresh.input_at + done, part);
        done += part.size();
    }
    if (old_hash.digest() != old.hash)
        fail_damaged(from.name(), "the hash of the input does not match the submitted job");
    fresh.hash = fresh_hash.digest();
    const std::string end = encode_job_end(block, fresh.hash);
    to.write(fresh.input_at + bytes, std::as_bytes(std::span(end)));
    return fresh;
}

/// Converts the file of a job that was submitted to a server with another algorithm version (job_hash.hpp), so that this server runs it.
/// Rewrites BASE.job with the algorithm version of this program, and its hash. On return the new file has replaced the old one, and is on
/// the disk. Returns the contents besides the input.
/// Requires: the job has no result.
/// Throws: Error{io_failed} if the input does not match the hash of the old version; then, and after any other error, the old file stays.
StoredSpec upgrade_job(const std::string& base, const StoredSpec& old) {
    const std::string path = base + ".job";
    const File from(path, File::Mode::read);
    const File to(path + ".part", File::Mode::create);
    try {
        StoredSpec fresh = rewrite(from, to, old);
        to.finish(path);
        return fresh;
    } catch (...) {
        remove_file(to.path());
        throw;
    }
}

}  // namespace

PairsInFile::Target DetachedJobs::result_target(const std::string& base, const StoredSpec& stored) const {
    return {base + ".result", stored.hash, server_.state->disk(), server_.options.limits.pairs, stored.owner};
}

std::shared_ptr<ServerJob> DetachedJobs::make_job(StoredJob::Parts parts, Budget::Reservation slot) const {
    ServerJob::Parts job;
    job.owner = parts.stored.owner;
    job.spec = parts.stored.spec;
    job.pairs = parts.pairs;
    job.slot = std::move(slot);
    job.record = std::make_shared<StoredJob>(std::move(parts));
    return server_.make_job(std::move(job));
}

void DetachedJobs::restore() {
    std::uint64_t queued = 0, ended = 0;
    std::vector<StateFolder::Found> jobs = server_.state->find_jobs();
    remove_superseded(jobs);
    for (StateFolder::Found& found : jobs) {
        try {
            const bool is_ended = found.result || found.damage;
            restore(std::move(found));
            ++(is_ended ? ended : queued);
        } catch (const Error& error) {
            log_text(*server_.log, LogLevel::error,
                     std::string("a job of the state folder is skipped: ") + error.what());
        }
    }
    if (queued + ended == 0) return;
    log_text(*server_.log, LogLevel::info,
             "detached jobs: " + std::to_string(queued) + " queued again, " + std::to_string(ended) + " have ended");
}

/// Converts a job of an older algorithm version that has no result (upgrade_job()). Returns the error if the conversion fails.
std::optional<Error> DetachedJobs::upgrade(StateFolder::Found& found) const {
    try {
        const std::uint32_t before = found.stored.algorithm;
        found.stored = upgrade_job(found.base, found.stored);
        log_text(*server_.log, LogLevel::info,
                 "job " + found.stored.spec.id() + ": converted from algorithm version " + std::to_string(before));
        return {};
    } catch (const Error& error) {
        return error;
    }
}

void DetachedJobs::restore(StateFolder::Found found) {
    std::optional<Error> damage = std::move(found.damage);
    if (!found.result && !damage && found.stored.algorithm != algorithm_version) damage = upgrade(found);
    const std::uint64_t memory_bytes = server_.memory_of(found.stored.spec);
    if (!found.result && !damage) {
        try {
            server_.check_limits(found.stored.spec);
            server_.memory.check(memory_bytes);
        } catch (const LimitError& limit) {
            damage = limit;  // not stored: a server with higher limits will run the job
        }
    }
    const std::string name = "job " + found.stored.spec.id();
    if (damage) log_text(*server_.log, LogLevel::error, name + ": " + damage->what());
    auto pairs = found.result ? std::make_shared<PairsInFile>(result_target(found.base, found.stored), *found.result,
                                                              std::move(found.result_disk))
                              : std::make_shared<PairsInFile>(result_target(found.base, found.stored));
    Budget::Reservation slot;
    if (!found.result && !damage) {
        try {
            slot = server_.job_slots.take(1, found.stored.owner);
        } catch (const LimitError&) {
            log_text(*server_.log, LogLevel::warning,
                     name + ": accepted, although the server now has more jobs than its limits allow");
        }
    }
    const v1::JobReport ending =
        damage ? report_of(found.stored, *damage) : found.result.value_or(StoredResult()).ending;
    const bool ended = damage || found.result;
    const auto job = make_job({*server_.state, found.base, std::move(found.stored), std::move(found.disk),
                               std::move(pairs), server_.memory, memory_bytes},
                              std::move(slot));
    ended ? job->set_ended(ending) : set_queued(*job);
    (void)server_.jobs.enter(job);
    if (!ended) server_.queue(job);
}

Submission DetachedJobs::begin(const std::string& owner, v1::JobSpec spec) {
    return server_.within_limits(owner, [&] { return begin_job(owner, std::move(spec)); });
}

Submission DetachedJobs::begin_job(const std::string& owner, v1::JobSpec spec) {
    check_id(spec.id());
    spec.clear_offset();
    server_.check_limits(spec);
    server_.memory.check(server_.memory_of(spec));
    StoredSpec stored;
    stored.owner = owner;
    stored.algorithm = algorithm_version;
    stored.spec = std::move(spec);
    Submission submission;
    if (server_.jobs.look_up(owner, stored.spec.id())) {
        submission.upload = std::make_unique<StoredUpload>(std::move(stored));
        return submission;
    }
    submission.slot = server_.job_slots.take(1, owner);
    submission.upload = std::make_unique<StoredUpload>(*server_.state, std::move(stored));
    return submission;
}

/// Returns the existing job with the owner, id and hash of `upload`, or null.
std::shared_ptr<ServerJob> DetachedJobs::find_same(const StoredUpload& upload) const {
    const std::string &owner = upload.stored().owner, &id = upload.stored().spec.id();
    std::shared_ptr<ServerJob> known = server_.jobs.look_up(owner, id);
    if (known && (!known->detached() || known->input_hash() != upload.hash())) {
        throw Error(ErrorCode::bad_input, "job " + id + " already exists, with other input or options");
    }
    return known;
}

void DetachedJobs::set_queued(ServerJob& job) const {
    server_.server_log.job_state_changed(job, {}, v1::UPLOADING);
    job.queue();
}

/// Detached jobs are entered only on the thread of the disk queue, so find_same() and enter() cannot race with each other.
std::shared_ptr<ServerJob> DetachedJobs::commit(Submission& submission) {
    StoredUpload& upload = *submission.upload;
    if (auto known = find_same(upload)) return known;
    if (!upload.has_file()) return {};
    const std::string base = upload.commit();
    StoredSpec stored = upload.stored();
    const std::uint64_t memory_bytes = server_.memory_of(stored.spec);
    auto pairs = std::make_shared<PairsInFile>(result_target(base, stored));
    auto job = make_job(
        {*server_.state, base, std::move(stored), upload.take_disk(), std::move(pairs), server_.memory, memory_bytes},
        std::move(submission.slot));
    set_queued(*job);
    try {
        (void)server_.jobs.enter(job);
    } catch (...) {
        server_.server_log.job_state_changed(*job, v1::QUEUED, v1::CANCELLED);
        throw;
    }
    upload.hand_over();
    server_.queue(job);
    return job;
}

void DetachedJobs::release(const ServerJob& job) {
    server_.jobs.remove(job);
    static_cast<StoredJob&>(*job.record()).remove();
}

void DetachedJobs::check_deadline(std::chrono::steady_clock::time_point now) {
    constexpr std::chrono::milliseconds expiry_interval(500);
    if (now - last_check_ < expiry_interval) return;
    last_check_ = now;
    for (const auto& job : server_.jobs.all()) {
        const auto ended = job->ended_at();
        if (!job->detached() || !ended || now - *ended < server_.options.keep) continue;
        server_.jobs.remove(*job);
        server_.state->disk_queue().add([job] { static_cast<StoredJob&>(*job->record()).remove(); });
    }
}

void DetachedJobs::abandon() {
    for (const auto& job : server_.jobs.all()) {
        if (job->detached()) job->abandon();
    }
}

}  // namespace octopair::service
