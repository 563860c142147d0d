#include "io/results/collision_writer.hpp"

#include <algorithm>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "io/files/atomic_file.hpp"
#include "io/json/json_fields.hpp"
#include "io/json/json_text.hpp"
#include "io/results/collision_columns.hpp"
#include "io/results/pair_writer.hpp"
#include "octopair/error.hpp"

namespace octopair::io {

namespace {

class CollisionJsonlWriter final : public CollisionWriter {
public:
    CollisionJsonlWriter(std::unique_ptr<OutputStream> out, const CollisionForm& form)
        : out_(std::move(out)), form_(form) {}

    void write(const CollisionRows& rows) override {
        for (std::size_t i = 0; i < rows.pairs.size(); ++i) out_->write(json_line(record_of(rows, i, form_)) + '\n');
    }

    void write_gone(std::span<const std::string_view> lines) override {
        for (const std::string_view line : lines) {
            out_->write(with_key(line, "change", word_of(Change::gone)) + '\n');
        }
    }

    void finish() override { out_->commit(); }

private:
    std::unique_ptr<OutputStream> out_;
    CollisionForm form_;
};

class CollisionCsvWriter final : public CollisionWriter {
public:
    CollisionCsvWriter(std::unique_ptr<OutputStream> out, const CollisionForm& form)
        : out_(std::move(out)), form_(form) {
        if (!form_.statuses) form_.names.a.keys = form_.names.b.keys = nullptr;  // no column needs them
        std::string header;
        const CollisionRecord none;
        for_each_csv_column(none, [&](std::string_view name, const auto&) {
            shown_.push_back(is_shown(name));
            if (shown_.back()) header += fmt::format("{}{}", header.empty() ? "" : ",", name);
        });
        out_->write(header + '\n');
    }

    void write(const CollisionRows& rows) override {
        for (std::size_t i = 0; i < rows.pairs.size(); ++i) write(record_of(rows, i, form_));
    }

    void write_gone(std::span<const std::string_view> lines) override {
        for (const std::string_view line : lines) {
            const nlohmann::json row = parse_json(line, "older result");
            CollisionRecord record = read_collision({row, "older result"});
            record.change = Change::gone;
            write(record);
        }
    }

    void finish() override { out_->commit(); }

private:
    /// Returns whether the file has a column. Details that no object has, files of a result with one input, changes without a baseline, and
    /// keys and comments without statuses get no column.
    bool is_shown(std::string_view name) const {
        if (name == "change") return form_.changes;
        if (name == "key" || name == "status" || name == "comment") return form_.statuses;
        if (name == columns_of_a.file || name == columns_of_b.file) return form_.files;
        for (const Detail detail : all_details) {
            const std::size_t i = std::size_t(detail);
            if (name == columns_of_a.details[i] || name == columns_of_b.details[i]) {
                return form_.names.a.has(detail) || form_.names.b.has(detail);
            }
        }
        return true;
    }

    void write(const CollisionRecord& row) { out_->write(csv_line(row, shown_) + '\n'); }

    std::unique_ptr<OutputStream> out_;
    CollisionForm form_;
    std::vector<bool> shown_;  // for each column of for_each_csv_column()
};

}  // namespace

std::unique_ptr<CollisionWriter> make_collision_jsonl_writer(std::unique_ptr<OutputStream> out,
                                                             const CollisionForm& form) {
    return std::make_unique<CollisionJsonlWriter>(std::move(out), form);
}

std::unique_ptr<CollisionWriter> make_collision_csv_writer(std::unique_ptr<OutputStream> out,
                                                           const CollisionForm& form) {
    return std::make_unique<CollisionCsvWriter>(std::move(out), form);
}

std::unique_ptr<CollisionWriter> make_collision_file_writer(const std::string& path, const CollisionForm& form) {
    switch (result_format(path)) {
        case ResultFormat::csv:
            return make_collision_csv_writer(std::make_unique<AtomicFile>(path), form);
        case ResultFormat::jsonl:
            return make_collision_jsonl_writer(std::make_unique<AtomicFile>(path), form);
        case ResultFormat::npy:
        case ResultFormat::bcf:
            break;
    }
    throw Error(ErrorCode::usage,
                fmt::format("{}: .npy can hold only pairs; write collisions to .csv or .jsonl", path));
}

}  // namespace octopair::io
