#include "service/server/store/stored_job.hpp"

#include <algorithm>
#include <utility>

#include "base/memory.hpp"
#include "base/stop.hpp"
#include "octopair/error.hpp"
#include "service/protocol/errors.hpp"
#include "service/protocol/job_spec.hpp"
#include "service/protocol/messages.hpp"
#include "service/server/jobs/uploaded_input.hpp"
#include "service/server/log/log_line.hpp"

namespace octopair::service {

std::optional<Budget::Reservation> StoredJob::ask_memory() {
    try {
        return parts_.memory.take(parts_.memory_bytes, parts_.stored.owner);
    } catch (const LimitError&) {
        return {};
    }
}

std::unique_ptr<UploadedInput> StoredJob::load(const std::shared_ptr<Engine>& engine,
                                               const std::stop_token& stop) const {
    const File file(parts_.base + ".job", File::Mode::read);
    auto input = std::make_unique<UploadedInput>(parts_.stored.spec, engine);
    Buffer<std::byte> piece(piece_bytes);
    for (std::uint64_t at = parts_.stored.input_at; input->missing() > 0;) {
        throw_if_stopped(stop);
        const auto bytes = piece.span().first(std::size_t(std::min<std::uint64_t>(input->missing(), piece.size())));
        file.read(at, bytes);
        input->append(bytes);
        at += bytes.size();
    }
    if (input->hash() != parts_.stored.hash)
        fail_damaged(file.name(), "the hash of the input does not match the submitted job");
    return input;
}

void StoredJob::end(const v1::JobReport& ending) {
    if (ending.state() != v1::DONE) parts_.pairs->discard();
    try {
        parts_.pairs->seal(ending);
    } catch (const std::exception& error) {
        if (ending.state() == v1::DONE && dynamic_cast<const NoRoomError*>(&error) != nullptr) throw;
        log_text(parts_.folder.log(), LogLevel::error,
                 "job " + parts_.stored.spec.id() + ": cannot store how the job ended: " + error.what());
        throw;
    }
}

void StoredJob::wait_for_room(const NoRoomError& why, std::chrono::duration<double> run) {
    const std::uint64_t needed = parts_.pairs->needed_bytes();
    const bool more = needed > needed_bytes_;
    needed_bytes_ = needed;
    parts_.pairs->discard();
    parts_.folder.disk().check(parts_.disk.amount() + needed_bytes_);
    const std::uint64_t most = parts_.folder.disk_space().total;
    if (parts_.disk.amount() + needed_bytes_ > most) {
        throw Error(ErrorCode::io_failed, "the result does not fit on the server's disk, which has " +
                                              std::to_string(most) + " bytes in all");
    }
    if (pause_.count() == 0) {
        log_text(parts_.folder.log(), LogLevel::warning,
                 "job " + parts_.stored.spec.id() + ": waits for room for its result: " + why.what());
    }
    // A run that ends without enough room is lost work, and the next run may find more pairs than needed_bytes_ counts. So the pause is
    // eight times as long as the run. If this run needed no more than the run before, free space is not what lacks, but for example a
    // quota: then each pause is at least twice as long as the last.
    constexpr std::chrono::duration<double> shortest(0.1), longest(60);
    pause_ =
        std::clamp<std::chrono::duration<double>>(more ? 8 * run : std::max(8 * run, 2 * pause_), shortest, longest);
    next_check_ =
        std::chrono::steady_clock::now() + std::chrono::duration_cast<std::chrono::steady_clock::duration>(pause_);
}

bool StoredJob::has_room() {
    constexpr std::chrono::milliseconds apart(100);
    const auto now = std::chrono::steady_clock::now();
    if (now < next_check_) return false;
    next_check_ = now + apart;
    // Besides the pairs, the file has a head and an end, and the disk stores whole blocks. So require one more block.
    constexpr std::uint64_t block = 4096;
    return parts_.folder.disk_space().free >= needed_bytes_ + block &&
           parts_.folder.disk().has(needed_bytes_, parts_.stored.owner);
}

/// Deletes N.job first: after a crash a server removes a result without a job, but would run a job without a result.
void StoredJob::remove() noexcept {
    remove_file(parts_.base + ".job");
    parts_.pairs->remove();
    (void)sync_folder_of(parts_.base);
    parts_.disk.give_back();
}

StoredUpload::StoredUpload(StoredSpec stored)
    : stored_(std::move(stored)), hash_(stored_.spec), missing_(input_bytes(stored_.spec)) {}

StoredUpload::StoredUpload(StateFolder& folder, StoredSpec stored) : StoredUpload(std::move(stored)) {
    block_ = encode_block(stored_);
    const std::uint64_t bytes = job_file_bytes(block_, missing_);
    disk_ = folder.disk().take(bytes + StateFolder::overhead_bytes, stored_.owner);
    base_ = folder.new_base();
    job_path_ = base_ + ".job";
    file_ = File(base_ + ".job.part", File::Mode::create);
    try {
        file_.reserve(bytes);
        file_.write(0, std::as_bytes(std::span(block_)));
    } catch (...) {
        remove_file(file_.path());
        throw;
    }
    stored_.input_at = at_ = block_.size();
}

StoredUpload::~StoredUpload() {
    if (!file_.open() || handed_over_) return;
    remove_file(file_.path());
    remove_file(job_path_);
}

void StoredUpload::append(std::span<const std::byte> data) {
    check_fits(data, missing_);
    missing_ -= data.size();
    hash_.add(data);
    if (file_.open()) file_.write(at_, data);
    at_ += data.size();
}

std::string StoredUpload::commit() {
    stored_.hash = hash_.digest();
    const std::string end = encode_job_end(block_, stored_.hash);
    file_.write(at_, std::as_bytes(std::span(end)));
    file_.finish(job_path_);
    return base_;
}

}  // namespace octopair::service
