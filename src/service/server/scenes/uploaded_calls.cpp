#include "service/server/scenes/uploaded_calls.hpp"

#include <cstring>
#include <string>

namespace octopair::service {

void UploadedCalls::append(std::span<const std::byte> piece) {
    if (reader_) {
        const std::uint64_t read = reader_->position() - (end_ - kept_.size());
        kept_.erase(kept_.begin(), kept_.begin() + std::ptrdiff_t(read));
    }
    kept_.insert(kept_.end(), piece.begin(), piece.end());
    end_ += piece.size();
}

bool UploadedCalls::next(RecordedCall& call) {
    if (!reader_) {
        if (end_ < sizeof(RecordingHead)) return false;
        const auto read = [this](std::uint64_t offset, std::span<std::byte> out) {
            const std::size_t at = std::size_t(offset - (end_ - kept_.size()));
            if (!out.empty()) std::memcpy(out.data(), kept_.data() + at, out.size());
        };
        reader_.emplace(RecordingSource{"scene", end_, read});
    }
    reader_->grow(end_);
    const std::uint64_t begin = reader_->position();
    const bool complete = reader_->next(call);
    if ((complete ? reader_->position() : end_) - begin > max_record_bytes) {
        reader_->refuse(begin,
                        "a record of more than " + std::to_string(max_record_bytes) + " bytes; send smaller calls");
    }
    return complete;
}

}  // namespace octopair::service
