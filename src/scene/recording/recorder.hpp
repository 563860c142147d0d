// Recorder: writes the calls of a scene to a file (recording.hpp), each before it is applied.
//
// Invariants
//   The file holds accepted calls only. A record that cannot be written completely is removed again.
//   If the process dies, at most the last record in the file is truncated.
//   The buffer is written to the file before and after each step.
//   Nothing is synced: written records survive a crash of the process, but not necessarily of the machine.
#pragma once

#include <initializer_list>
#include <string>

#include "base/descriptor.hpp"
#include "base/memory.hpp"
#include "scene/recording/recording.hpp"

namespace octopair {

/// All calls throw Error{io_failed} if the system reports an error; the recording is then unchanged. A process that reaches
/// the limit of file sizes is killed by SIGXFSZ, unless it ignores this signal.
class Recorder final : public CallEncoder {
public:
    /// Creates the file, or truncates an existing one.
    explicit Recorder(const SceneOptions& options);
    Recorder(const Recorder&) = delete;
    Recorder& operator=(const Recorder&) = delete;
    ~Recorder() override;

    /// Writes all buffered calls and the record of the step. They are in the file even if the process dies in this step.
    void begin_step();
    /// Writes the result of the step. A write error is reported by the next call, which tries again.
    void end_step(const StepResult& result) noexcept;

private:
    void append(RecordKind kind, std::initializer_list<Bytes> pieces) override;
    void keep(Bytes bytes);
    void flush();
    void write_large(std::initializer_list<Bytes> pieces, const RecordHead& head, std::uint64_t checksum);
    void write_at(std::uint64_t offset, Bytes bytes);

    std::string path_;
    Descriptor descriptor_;
    std::uint64_t end_ = 0;     // size of the file: end of its last record
    Buffer<std::byte> buffer_;  // complete records that are not in the file yet
    std::size_t used_ = 0;      // bytes of the buffer in use
};

}  // namespace octopair
