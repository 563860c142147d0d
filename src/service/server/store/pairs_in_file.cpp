#include "service/server/store/pairs_in_file.hpp"

#include <algorithm>
#include <utility>

#include "octopair/error.hpp"
#include "service/protocol/errors.hpp"
#include "service/protocol/messages.hpp"
#include "service/server/jobs/job_record.hpp"

namespace octopair::service {

PairsInFile::PairsInFile(Target target, StoredResult stored, Budget::Reservation reservation)
    : target_(std::move(target)),
      reservation_(std::move(reservation)),
      sums_(std::move(stored.sums)),
      ready_(stored.pairs) {}

PairsInFile::~PairsInFile() { discard(); }

void PairsInFile::append(std::span<const Pair> pairs) {
    size_ += pairs.size();
    check_pair_limit(size_, target_.max_pairs);
    if (piece_.size() == 0) piece_.resize_discard(stored_piece_pairs);
    while (!pairs.empty()) {
        const std::size_t count = std::min(piece_.size() - used_, pairs.size());
        std::copy_n(pairs.begin(), count, piece_.data() + used_);
        used_ += count;
        pairs = pairs.subspan(count);
        if (used_ == piece_.size()) write_piece();
    }
}

void PairsInFile::finish() {
    if (used_ > 0) write_piece();
    piece_.clear();
}

/// Appends the piece to the file. On return its pairs are readable.
void PairsInFile::write_piece() {
    open();
    const auto bytes = std::as_bytes(std::as_const(piece_).span().first(used_));
    take_room(bytes.size() + sizeof(std::uint64_t));
    part_->write(result_head_bytes + ready_ * sizeof(Pair), bytes);
    const std::uint64_t sum = checksum_of(bytes);
    const std::lock_guard lock(mutex_);
    sums_.push_back(sum);
    ready_ += used_;
    used_ = 0;
}

void PairsInFile::take_room(std::uint64_t bytes) {
    const std::lock_guard lock(mutex_);
    needed_bytes_ = reservation_.amount() + bytes;
    try {
        reservation_.grow(bytes);
    } catch (const LimitError& full) {
        target_.disk.check(reservation_.amount() + bytes);
        throw NoRoomError(full.what());
    }
}

std::uint64_t PairsInFile::needed_bytes() const {
    const std::lock_guard lock(mutex_);
    return needed_bytes_;
}

void PairsInFile::open() {
    if (part_) return;
    auto part = std::make_shared<File>(target_.path + ".part", File::Mode::create);
    const std::string head = encode_result_head(target_.hash);
    try {
        part->write(0, std::as_bytes(std::span(head)));
    } catch (...) {
        remove_file(part->path());
        throw;
    }
    const std::lock_guard lock(mutex_);
    part_ = std::move(part);
}

std::optional<grpc::Slice> PairsInFile::piece(std::uint64_t offset) const {
    const std::uint64_t number = offset / stored_piece_pairs, first = number * stored_piece_pairs;
    std::shared_ptr<File> file;
    std::uint64_t sum = 0, pairs = 0;
    {
        const std::lock_guard lock(mutex_);
        if (removed_) throw Error(ErrorCode::bad_input, "the job was released while its result was read");
        if (offset >= ready_) return {};
        file = part_ ? part_ : std::make_shared<File>(target_.path, File::Mode::read);
        sum = sums_[std::size_t(number)];
        pairs = std::min(stored_piece_pairs, ready_ - first);
    }
    grpc::Slice piece = make_slice(std::size_t(pairs * sizeof(Pair)));
    const std::span bytes = room_in(piece);
    file->read(result_head_bytes + first * sizeof(Pair), bytes);
    if (checksum_of(bytes) != sum) {
        fail_damaged(name_of_file(target_.path),
                     "wrong checksum of the piece that begins with pair " + std::to_string(first));
    }
    const std::size_t begin = std::size_t(offset - first) * sizeof(Pair);
    return begin == 0 ? piece : piece.sub(begin, piece.size());
}

std::uint64_t PairsInFile::ready() const {
    const std::lock_guard lock(mutex_);
    return ready_;
}

void PairsInFile::discard() noexcept {
    const std::lock_guard lock(mutex_);
    piece_.clear();
    used_ = 0;
    size_ = 0;
    if (!part_) return;
    remove_file(target_.path + ".part");
    part_.reset();
    sums_.clear();
    ready_ = 0;
    reservation_.give_back();
}

void PairsInFile::seal(const v1::JobReport& ending) {
    open();
    const std::string end = encode_result_end({target_.hash, ready_, sums_, ending});
    part_->write(result_head_bytes + ready_ * sizeof(Pair), std::as_bytes(std::span(end)));
    part_->finish(target_.path);
    const std::lock_guard lock(mutex_);
    part_.reset();
}

void PairsInFile::remove() noexcept {
    discard();
    const std::lock_guard lock(mutex_);
    removed_ = true;
    remove_file(target_.path);
    reservation_.give_back();
}

}  // namespace octopair::service
