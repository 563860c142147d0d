#include "io/results/pair_writer.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <filesystem>
#include <optional>

#include <fmt/format.h>

#include "io/boxes/npy_header.hpp"
#include "io/files/atomic_file.hpp"
#include "io/json/json_text.hpp"
#include "octopair/error.hpp"

namespace octopair::io {

namespace {

char* put_number(char* at, std::uint32_t number) { return std::to_chars(at, at + 10, number).ptr; }

class NpyWriter final : public PairWriter {
public:
    NpyWriter(std::string path, bool moving) : path_(std::move(path)), moving_(moving) {
        if (!moving_) open(path_);  // opened now, so that a path that cannot be written fails before the search
    }

    void begin_frame(std::uint64_t frame) override {
        if (moving_) open(frame_path(path_, frame));
    }
    void write(std::span<const Pair> pairs) override {
        static_assert(sizeof(Pair) == 2 * sizeof(std::uint32_t));
        file_->write(std::as_bytes(pairs));
        count_ += pairs.size();
    }
    void end_frame() override {
        if (moving_) close();
    }
    void finish() override {
        if (!moving_) close();
    }

private:
    void open(const std::string& path) {
        file_.emplace(path);
        count_ = 0;
        file_->write(header());
    }
    void close() {
        file_->write_at(0, header());
        file_->commit();
        file_.reset();
    }
    std::string header() const { return make_npy_header(NpyType::uint32, std::array<std::uint64_t, 2>{count_, 2}); }

    std::string path_;
    bool moving_;
    std::optional<AtomicFile> file_;
    std::uint64_t count_ = 0;
};

class CsvWriter final : public PairWriter {
public:
    CsvWriter(std::unique_ptr<OutputStream> out, bool moving) : out_(std::move(out)), moving_(moving) {
        out_->write(moving_ ? std::string_view("frame,a,b\n") : std::string_view("a,b\n"));
    }

    void begin_frame(std::uint64_t frame) override {
        if (moving_) frame_ = fmt::format("{},", frame);
    }
    void write(std::span<const Pair> pairs) override { write_csv_rows(*out_, frame_, pairs); }
    void end_frame() override {}
    void finish() override { out_->commit(); }

private:
    std::unique_ptr<OutputStream> out_;
    bool moving_;
    std::string frame_;
};

class JsonlWriter final : public PairWriter {
public:
    JsonlWriter(std::unique_ptr<OutputStream> out, bool moving, const PairNames& names)
        : out_(std::move(out)), moving_(moving), rows_(names) {}

    void begin_frame(std::uint64_t frame) override {
        if (moving_) frame_ = fmt::format("\"frame\":{},", frame);
    }
    void write(std::span<const Pair> pairs) override { rows_.write(*out_, frame_, pairs); }
    void end_frame() override {}
    void finish() override { out_->commit(); }

private:
    std::unique_ptr<OutputStream> out_;
    bool moving_;
    JsonlRows rows_;
    std::string frame_;
};

}  // namespace

void write_csv_rows(OutputStream& out, std::string_view begin, std::span<const Pair> pairs) {
    for (const Pair pair : pairs) {
        char* const row = out.room(begin.size() + 32);
        char* at = put_number(std::copy(begin.begin(), begin.end(), row), pair.a);
        *at++ = ',';
        at = put_number(at, pair.b);
        *at++ = '\n';
        out.advance(std::size_t(at - row));
    }
}

void JsonlRows::write(OutputStream& out, std::string_view begin, std::span<const Pair> pairs) {
    for (const Pair pair : pairs) {
        line_ = '{';
        line_ += begin;
        append_number("\"a\":", pair.a);
        append_number(",\"b\":", pair.b);
        append_name("a_name", names_.a, pair.a);
        append_name("b_name", names_.b, pair.b);
        line_ += "}\n";
        out.write(line_);
    }
}

void JsonlRows::append_name(std::string_view key, const std::vector<std::string>* names, std::uint32_t object) {
    if (names == nullptr || names->empty() || (*names)[object].empty()) return;
    line_ += fmt::format(",\"{}\":{}", key, json_string((*names)[object]));
}

void JsonlRows::append_number(std::string_view before, std::uint32_t number) {
    char digits[10];
    line_ += before;
    line_.append(digits, put_number(digits, number));
}

std::string frame_path(const std::string& path, std::uint64_t frame) {
    const std::size_t dot = path.rfind('.');
    return fmt::format("{}.{:06}{}", path.substr(0, dot), frame, dot == std::string::npos ? "" : path.substr(dot));
}

std::unique_ptr<PairWriter> make_npy_writer(const std::string& path, bool moving) {
    return std::make_unique<NpyWriter>(path, moving);
}

std::unique_ptr<PairWriter> make_csv_writer(std::unique_ptr<OutputStream> out, bool moving) {
    return std::make_unique<CsvWriter>(std::move(out), moving);
}

std::unique_ptr<PairWriter> make_jsonl_writer(std::unique_ptr<OutputStream> out, bool moving, const PairNames& names) {
    return std::make_unique<JsonlWriter>(std::move(out), moving, names);
}

std::unique_ptr<PairWriter> make_file_writer(const std::string& path, bool moving, const PairNames& names) {
    switch (pairs_format(path)) {
        case ResultFormat::npy:
            return make_npy_writer(path, moving);
        case ResultFormat::csv:
            return make_csv_writer(std::make_unique<AtomicFile>(path), moving);
        case ResultFormat::jsonl:
            return make_jsonl_writer(std::make_unique<AtomicFile>(path), moving, names);
        case ResultFormat::bcf:
            break;
    }
    throw Error(ErrorCode::usage, "unknown pair format");
}

ResultFormat event_format(const std::string& path) {
    const ResultFormat format = result_format(path);
    if (format == ResultFormat::csv || format == ResultFormat::jsonl) return format;
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
