#include "io/pair_writer.hpp"

#include <array>
#include <charconv>
#include <cstring>
#include <filesystem>
#include <optional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "io/atomic_file.hpp"
#include "io/npy_header.hpp"
#include "octopair/error.hpp"

namespace octopair::io {

namespace {

class NpyWriter final : public PairWriter {
public:
    NpyWriter(std::string path, bool moving) : path_(std::move(path)), moving_(moving) {
        if (!moving_) open(path_);  // at once: what cannot be written is known before the work
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

char* put_number(char* at, std::uint64_t number) { return std::to_chars(at, at + 20, number).ptr; }

class CsvWriter final : public PairWriter {
public:
    CsvWriter(std::unique_ptr<OutputStream> out, bool moving) : out_(std::move(out)), moving_(moving) {
        out_->write(moving_ ? std::string_view("frame,a,b\n") : std::string_view("a,b\n"));
    }

    void begin_frame(std::uint64_t frame) override {
        if (moving_) frame_ = fmt::format("{},", frame);
    }
    void write(std::span<const Pair> pairs) override {
        for (const Pair pair : pairs) {
            char* const begin = out_->room(64);
            char* at = begin;
            std::memcpy(at, frame_.data(), frame_.size());
            at = put_number(at + frame_.size(), pair.a);
            *at++ = ',';
            at = put_number(at, pair.b);
            *at++ = '\n';
            out_->advance(std::size_t(at - begin));
        }
    }
    void end_frame() override {}
    void finish() override { out_->commit(); }

private:
    std::unique_ptr<OutputStream> out_;
    bool moving_;
    std::string frame_;
};

/// The name as a JSON string; what is not UTF-8 in it becomes U+FFFD.
std::string json_string(const std::string& name) {
    return nlohmann::json(name).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

class JsonlWriter final : public PairWriter {
public:
    JsonlWriter(std::unique_ptr<OutputStream> out, bool moving, const PairNames& names)
        : out_(std::move(out)), moving_(moving), names_(names) {}

    void begin_frame(std::uint64_t frame) override {
        if (moving_) frame_ = fmt::format("\"frame\":{},", frame);
    }
    void write(std::span<const Pair> pairs) override {
        for (const Pair pair : pairs) {
            line_.clear();
            fmt::format_to(std::back_inserter(line_), "{{{}\"a\":{},\"b\":{}", frame_, pair.a, pair.b);
            append_name("a_name", names_.a, pair.a);
            append_name("b_name", names_.b, pair.b);
            line_ += "}\n";
            out_->write(line_);
        }
    }
    void end_frame() override {}
    void finish() override { out_->commit(); }

private:
    void append_name(std::string_view key, const std::vector<std::string>* names, std::uint32_t object) {
        if (names == nullptr || names->empty() || (*names)[object].empty()) return;
        fmt::format_to(std::back_inserter(line_), ",\"{}\":{}", key, json_string((*names)[object]));
    }

    std::unique_ptr<OutputStream> out_;
    bool moving_;
    PairNames names_;
    std::string frame_;
    std::string line_;
};

}  // namespace

PairFormat pair_format(const std::string& path) {
    const std::string ending = std::filesystem::path(path).extension().string();
    if (ending == ".npy") return PairFormat::npy;
    if (ending == ".csv") return PairFormat::csv;
    if (ending == ".jsonl") return PairFormat::jsonl;
    throw Error(ErrorCode::usage, fmt::format("{}: the name of a pairs file ends in .npy, .csv or .jsonl", path));
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
    switch (pair_format(path)) {
        case PairFormat::npy:
            return make_npy_writer(path, moving);
        case PairFormat::csv:
            return make_csv_writer(std::make_unique<AtomicFile>(path), moving);
        case PairFormat::jsonl:
            return make_jsonl_writer(std::make_unique<AtomicFile>(path), moving, names);
    }
    throw Error(ErrorCode::usage, "unknown pair format");
}

}  // namespace octopair::io
