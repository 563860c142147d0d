#include "io/results/event_writer.hpp"

#include <fmt/format.h>

#include "octopair/error.hpp"

namespace octopair::io {

ResultFormat event_format(const std::string& path) {
    const ResultFormat format = result_format(path);
    if (format != ResultFormat::npy) return format;
    throw Error(ErrorCode::usage,
                fmt::format("{}: events are rows of text; the name of their file must end in .csv or .jsonl", path));
}

EventWriter::EventWriter(ResultFormat format, std::unique_ptr<OutputStream> out, const PairNames& names)
    : format_(format), out_(std::move(out)), jsonl_(names) {
    if (format_ == ResultFormat::npy) throw Error(ErrorCode::usage, "events are rows of text, not an array");
    if (format_ == ResultFormat::csv) out_->write("frame,event,a,b\n");
}

void EventWriter::write(std::uint64_t frame, Event event, std::span<const Pair> pairs) {
    const std::string_view word = event == Event::begin ? "begin" : "end";
    if (format_ == ResultFormat::csv) {
        write_csv_rows(*out_, fmt::format("{},{},", frame, word), pairs);
    } else {
        jsonl_.write(*out_, fmt::format("\"frame\":{},\"event\":\"{}\",", frame, word), pairs);
    }
}

}  // namespace octopair::io
