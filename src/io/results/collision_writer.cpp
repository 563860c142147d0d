#include "io/results/collision_writer.hpp"

#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "io/files/atomic_file.hpp"
#include "io/json/json_fields.hpp"
#include "io/json/json_text.hpp"
#include "io/results/pair_writer.hpp"
#include "octopair/error.hpp"

namespace octopair::io {

namespace {

std::string point_json(const Point3d& point) {
    return fmt::format("[{},{},{}]", json_number(point[0]), json_number(point[1]), json_number(point[2]));
}

std::string contact_json(const Contact& contact) {
    std::string text = fmt::format("{{\"point\":{},\"normal\":{},\"depth\":{}", point_json(contact.point),
                                   point_json(contact.normal), json_number(contact.depth));
    if (contact.feature_a != Contact::no_feature) text += fmt::format(",\"a_feature\":{}", contact.feature_a);
    if (contact.feature_b != Contact::no_feature) text += fmt::format(",\"b_feature\":{}", contact.feature_b);
    return text + '}';
}

class CollisionJsonlWriter final : public CollisionWriter {
public:
    CollisionJsonlWriter(std::unique_ptr<OutputStream> out, const CollisionForm& form)
        : out_(std::move(out)), form_(form) {}

    void write(const CollisionRows& rows) override {
        for (std::size_t i = 0; i < rows.pairs.size(); ++i) {
            const Pair pair = rows.pairs[i];
            line_ = fmt::format("{{\"a\":{},\"b\":{}", pair.a, pair.b);
            append_object("a", form_.names.a, pair.a);
            append_object("b", form_.names.b, pair.b);
            if (!rows.changes.empty()) append("change", fmt::format("\"{}\"", word_of(rows.changes[i])));
            if (!rows.findings.empty()) append_finding(rows.findings[i]);
            line_ += "}\n";
            out_->write(line_);
        }
    }

    void write_gone(std::span<const std::string_view> lines) override {
        for (const std::string_view line : lines) {
            out_->write(with_key(line, "change", word_of(Change::gone)) + '\n');
        }
    }

    void finish() override { out_->commit(); }

private:
    void append(std::string_view key, std::string_view value) { line_ += fmt::format(",\"{}\":{}", key, value); }

    void append_object(std::string_view side, const ObjectNames& names, std::uint32_t object) {
        const std::string_view name = names.of(object);
        if (!name.empty()) append(fmt::format("{}_name", side), json_string(name));
        for (const Detail detail : all_details) {
            const std::string_view text = names.detail(object, detail);
            if (!text.empty()) append(fmt::format("{}_{}", side, word_of(detail)), json_string(text));
        }
        if (!names.owners.empty()) append(fmt::format("{}_triangle", side), std::to_string(names.triangle(object)));
    }

    void append_finding(const Finding& finding) {
        const CollisionClass what = finding.collision_class;
        if (what == CollisionClass::unknown) return;
        append("class", fmt::format("\"{}\"", word_of(what)));
        if (form_.times) append("time", json_number(finding.time));
        if (!meet(what)) {
            append("distance", json_number(finding.distance));
            append("nearest", fmt::format("[{},{}]", point_json(finding.nearest[0]), point_json(finding.nearest[1])));
        } else if (form_.features) {
            if (finding.depth_kind != DepthKind::unknown) {
                append("depth", json_number(finding.depth));
                append("depth_kind", fmt::format("\"{}\"", word_of(finding.depth_kind)));
                if (finding.depth_kind == DepthKind::at_least)
                    append("depth_at_most", json_number(finding.depth_at_most));
            }
            append_contacts(finding);
        }
        if (finding.open[0]) append("a_open", "true");
        if (finding.open[1]) append("b_open", "true");
    }

    void append_contacts(const Finding& finding) {
        line_ += ",\"contacts\":[";
        for (std::size_t i = 0; i < finding.contacts.size(); ++i) {
            if (i > 0) line_ += ',';
            line_ += contact_json(finding.contacts[i]);
        }
        line_ += ']';
        if (finding.more_contacts) append("more_contacts", "true");
    }

    std::unique_ptr<OutputStream> out_;
    CollisionForm form_;
    std::string line_;
};

class CollisionCsvWriter final : public CollisionWriter {
public:
    CollisionCsvWriter(std::unique_ptr<OutputStream> out, const CollisionForm& form)
        : out_(std::move(out)), form_(form) {
        out_->write("a,b,a_name,b_name,class,distance,depth,time,contacts,points,more_contacts,depth_kind,open");
        for (const Detail detail : all_details) {
            if (!form_.names.a.has(detail) && !form_.names.b.has(detail)) continue;
            details_.push_back(detail);
            out_->write(fmt::format(",a_{0},b_{0}", word_of(detail)));
        }
        out_->write(form_.changes ? std::string_view(",change\n") : std::string_view("\n"));
    }

    void write(const CollisionRows& rows) override {
        for (std::size_t i = 0; i < rows.pairs.size(); ++i) {
            const Pair pair = rows.pairs[i];
            line_ = fmt::format("{},{},{},{}", pair.a, pair.b, csv_field(form_.names.a.of(pair.a)),
                                csv_field(form_.names.b.of(pair.b)));
            append_finding(rows.findings.empty() ? Finding() : rows.findings[i]);
            for (const Detail detail : details_) {
                append(csv_field(form_.names.a.detail(pair.a, detail)));
                append(csv_field(form_.names.b.detail(pair.b, detail)));
            }
            if (form_.changes) append(rows.changes.empty() ? std::string_view() : word_of(rows.changes[i]));
            line_ += '\n';
            out_->write(line_);
        }
    }

    void write_gone(std::span<const std::string_view> lines) override {
        for (const std::string_view line : lines) {
            const nlohmann::json row = parse_json(line, "older result");
            line_.clear();
            for (const char* key : {"a", "b", "a_name", "b_name", "class", "distance", "depth", "time"}) {
                append(old_field(row, key));
            }
            const auto contacts = row.find("contacts");
            const bool listed = contacts != row.end() && contacts->is_array();
            append(listed ? std::to_string(contacts->size()) : std::string());
            append(old_points(row));
            append(old_field(row, "more_contacts"));
            append(old_field(row, "depth_kind"));
            append(std::string(row.contains("a_open") ? "a" : "") + (row.contains("b_open") ? "b" : ""));
            for (const Detail detail : details_) {
                for (const char* side : {"a", "b"}) append(old_field(row, fmt::format("{}_{}", side, word_of(detail))));
            }
            append(word_of(Change::gone));
            line_ += '\n';
            out_->write(std::string_view(line_).substr(1));
        }
    }

    void finish() override { out_->commit(); }

private:
    void append(std::string_view field) {
        line_ += ',';
        line_ += field;
    }

    static std::string old_field(const nlohmann::json& row, const std::string& key) {
        const auto value = row.find(key);
        if (value == row.end() || value->is_null()) return {};
        if (value->is_string()) return csv_field(value->get_ref<const std::string&>());
        return value->is_number_float() ? json_number(value->get<double>()) : csv_field(dump_json(*value));
    }

    static std::string point_text(const Point3d& point) {
        return json_number(point[0]) + ' ' + json_number(point[1]) + ' ' + json_number(point[2]);
    }

    /// Returns the points of the contacts, or for objects that are apart, the two nearest points.
    std::string points(const Finding& finding) const {
        std::string text;
        const auto add = [&](const Point3d& point) { text += (text.empty() ? "" : ";") + point_text(point); };
        if (finding.collision_class == CollisionClass::clearance) {
            for (const Point3d& point : finding.nearest) add(point);
        } else if (form_.features) {
            for (const Contact& contact : finding.contacts) add(contact.point);
        }
        return text;
    }

    static std::string old_points(const nlohmann::json& row) {
        std::string text;
        const auto add = [&](const nlohmann::json& point) {
            if (!point.is_array() || point.size() != 3) return;
            for (const auto& number : point) {
                if (!number.is_number()) return;
            }
            text += (text.empty() ? "" : ";") + point_text(point.get<Point3d>());
        };
        for (const char* key : {"nearest", "contacts"}) {
            const auto list = row.find(key);
            if (list == row.end() || !list->is_array()) continue;
            for (const auto& one : *list) add(one.is_object() && one.contains("point") ? one["point"] : one);
        }
        return text;
    }

    void append_finding(const Finding& finding) {
        const CollisionClass what = finding.collision_class;
        const bool known = what != CollisionClass::unknown, features = form_.features && meet(what);
        const bool deep = features && finding.depth_kind != DepthKind::unknown;
        append(known ? word_of(what) : std::string_view());
        append(known && !meet(what) ? json_number(finding.distance) : std::string());
        append(deep ? json_number(finding.depth) : std::string());
        append(known && form_.times ? json_number(finding.time) : std::string());
        append(features ? std::to_string(finding.contacts.size()) : std::string());
        append(points(finding));
        append(features && finding.more_contacts ? "true" : "");
        append(deep ? word_of(finding.depth_kind) : std::string_view());
        append(std::string(finding.open[0] ? "a" : "") + (finding.open[1] ? "b" : ""));
    }

    std::unique_ptr<OutputStream> out_;
    CollisionForm form_;
    std::vector<Detail> details_;  // details that have columns
    std::string line_;
};

}  // namespace

std::string csv_field(std::string_view text) {
    std::string clean = clean_text(text);
    if (clean.find_first_of(",\"\r\n") == std::string::npos) return clean;
    std::string quoted = "\"";
    for (const char c : clean) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
    return quoted + '"';
}

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
            break;
    }
    throw Error(ErrorCode::usage,
                fmt::format("{}: .npy can hold only pairs; write collisions to .csv or .jsonl", path));
}

}  // namespace octopair::io
