#include "io/results/event_writer.hpp"

#include <fmt/format.h>

#include "octopair/error.hpp"

namespace octopair::io {

PairFormat event_format(const std::string& path) {
    const PairFormat format = pair_format(path);
    if (format != PairFormat::npy) return format;
    throw Error(ErrorCode::usage,
                fmt::format("{}: events are rows of text; the name of their file ends in .csv or .jsonl", path));
}

EventWriter::EventWriter(PairFormat format, std::unique_ptr<OutputStream> out, const PairNames& names)
    : format_(format), out_(std::move(out)), jsonl_(names) {
    if (format_ == PairFormat::npy) throw Error(ErrorCode::usage, "events are rows of text, not an array");
    if (format_ == PairFormat::csv) out_->write("frame,event,a,b\n");
}

void EventWriter::write(std::uint64_t frame, Event event, std::span<const Pair> pairs) {
    const std::string_view word = event == Event::begin ? "begin" : "end";
    if (format_ == PairFormat::csv) {
        write_csv_rows(*out_, fmt::format("{},{},", frame, word), pairs);
    } else {
        jsonl_.write(*out_, fmt::format("\"frame\":{},\"event\":\"{}\",", frame, word), pairs);
    }
}

}  // namespace octopair::io
