// Recorder: writes the calls of a scene to a file (recording.hpp), each before it is applied.
//
// The file is that of the calls that were accepted, at any time and whatever fails: a record that cannot be written is
// taken back, and a process that dies leaves at most the last record cut. What the buffer holds is written before and after
// each step. Nothing is synced: what was written outlives the process, but maybe not the machine.
#pragma once

#include <initializer_list>
#include <string>

#include "base/descriptor.hpp"
#include "base/memory.hpp"
#include "scene/recording/call_encoder.hpp"

namespace octopair {

/// All calls throw Error{io_failed} when the system refuses; the recording is then the same as before. (A limit of file
/// sizes ends a process that does not ignore SIGXFSZ.)
class Recorder final : public CallEncoder {
public:
    /// Empties a file that is there.
    explicit Recorder(const SceneOptions& options);
    Recorder(const Recorder&) = delete;
    Recorder& operator=(const Recorder&) = delete;
    ~Recorder() override;

    /// From here on, all calls and that a step began are in the file, even if the process dies in it.
    void begin_step();
    /// Cannot fail: what cannot be written now is tried again with the next call.
    void end_step(const StepResult& result) noexcept;

private:
    void append(RecordKind kind, std::initializer_list<Bytes> pieces) override;
    void keep(Bytes bytes);
    void flush();
    void write_large(std::initializer_list<Bytes> pieces, const RecordHead& head, std::uint64_t checksum);
    void write_at(std::uint64_t offset, Bytes bytes);

    std::string path_;
    Descriptor descriptor_;
    std::uint64_t end_ = 0;     // of the records that are in the file
    Buffer<std::byte> buffer_;  // whole records that come after these
    std::size_t used_ = 0;
};

}  // namespace octopair
