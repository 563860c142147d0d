#include "io/results/html_report.hpp"

#include <algorithm>
#include <limits>
#include <optional>
#include <unordered_map>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "io/json/json_fields.hpp"
#include "io/json/json_text.hpp"
#include "io/results/collision_columns.hpp"

namespace octopair::io {

namespace {

constexpr std::string_view data_mark = "@DATA@";

/// Escapes every "<", so that no text in the JSON can end its <script> element.
std::string script_json(std::string text) {
    for (std::size_t at = text.find('<'); at != std::string::npos; at = text.find('<', at))
        text.replace(at, 1, "\\u003c");
    return text;
}

std::string json_box(const Boxes& boxes, std::uint64_t object) {
    return std::visit(
        [object](auto span) {
            const auto& box = span[std::size_t(object)];
            return fmt::format("{},{},{},{},{},{}", json_number(double(box.min[0])), json_number(double(box.min[1])),
                               json_number(double(box.min[2])), json_number(double(box.max[0])),
                               json_number(double(box.max[1])), json_number(double(box.max[2])));
        },
        boxes);
}

std::uint64_t size_of(const Boxes& boxes) {
    return std::visit([](auto span) { return std::uint64_t(span.size()); }, boxes);
}

std::string name_of(const ObjectNames& names, std::uint32_t object) {
    const std::string name(names.of(object));
    return names.owners.empty() ? name : fmt::format("{}, triangle {}", name, names.triangle(object));
}

/// Returns a number that is larger for worse collisions. It orders the rows.
double severity_of(const CollisionRecord& row) {
    if (row.collision_class == CollisionClass::duplicate) return std::numeric_limits<double>::infinity();
    if (row.distance) return -*row.distance;
    return row.depth.value_or(0);
}

/// Returns a point where the objects of a pair meet or are nearest, or "null" if none is known.
std::string json_place(const CollisionRecord& row) {
    const bool met = row.contacts && !row.contacts->empty();
    if (!met && !row.nearest) return "null";
    const Point3d& at = met ? row.contacts->front().point : (*row.nearest)[0];
    return fmt::format("[{},{},{}]", json_number(at[0]), json_number(at[1]), json_number(at[2]));
}

std::string json_or_null(const std::optional<double>& value) { return value ? json_number(*value) : "null"; }

std::string json_count(const CollisionRecord& row) {
    return row.contacts ? std::to_string(row.contacts->size()) : "null";
}

std::string json_row(const CollisionRecord& row) {
    return fmt::format("[{},{},{},{},{},{},{},{},{},{},{},{},{}]", row.a.number, row.b.number,
                       int(row.collision_class.value_or(CollisionClass::unknown)),
                       row.change ? std::to_string(int(*row.change)) : "null", json_or_null(row.distance),
                       json_or_null(row.depth), json_or_null(row.time), json_count(row), int(row.more_contacts),
                       json_place(row), int(row.depth_kind == DepthKind::at_least), json_or_null(row.depth_at_most),
                       int(row.a.open) + 2 * int(row.b.open));
}

/// Returns the label of one object of a row of the baseline.
std::string old_label(const RecordedObject& object) {
    const std::string name = object.name.empty() ? fmt::format("#{}", object.number) : std::string(object.name);
    return object.triangle ? fmt::format("{}, triangle {}", name, *object.triangle) : name;
}

std::string gone_json(const CollisionRecord& row) {
    const auto detail = [](const RecordedObject& object, Detail what) {
        return json_string(object.details[std::size_t(what)]);
    };
    return fmt::format("[{},{},{},{},{},{},{},{},{},{},{},{}]", json_string(old_label(row.a)),
                       json_string(old_label(row.b)),
                       json_string(row.collision_class ? word_of(*row.collision_class) : std::string_view()),
                       json_or_null(row.distance), json_or_null(row.depth), json_or_null(row.time), json_count(row),
                       int(row.depth_kind == DepthKind::at_least), detail(row.a, Detail::label),
                       detail(row.a, Detail::type), detail(row.b, Detail::label), detail(row.b, Detail::type));
}

}  // namespace

/// Numbers distinct texts from 1 on, in the order of their first use. The empty text is 0.
class TextNumbers {
public:
    std::uint32_t of(std::string_view text) {
        if (text.empty()) return 0;
        const auto [place, is_new] = numbers_.try_emplace(text, std::uint32_t(texts_.size()));
        if (is_new) texts_.push_back(text);
        return place->second;
    }
    const std::vector<std::string_view>& texts() const { return texts_; }

private:
    std::vector<std::string_view> texts_ = {{}};
    std::unordered_map<std::string_view, std::uint32_t> numbers_;
};

HtmlReport::HtmlReport(std::unique_ptr<OutputStream> out, ReportScene scene)
    : out_(std::move(out)), scene_(std::move(scene)) {
    named_[0].resize(std::size_t(size_of(scene_.a)));
    named_[1].resize(std::size_t(scene_.join ? size_of(scene_.b) : 0));
    out_->write(report_page.substr(0, report_page.find(data_mark)));
}

void HtmlReport::begin_list(std::string_view id) {
    out_->write(fmt::format("<script type=\"application/json\" id=\"{}\">[", id));
    first_ = true;
}

void HtmlReport::end_list() { out_->write("]</script>\n"); }

void HtmlReport::separate() {
    if (!first_) out_->write(",\n");
    first_ = false;
}

void HtmlReport::write(const CollisionRows& rows) {
    for (std::size_t i = 0; i < rows.pairs.size(); ++i) {
        const CollisionRecord row = record_of(rows, i, scene_.form);
        ++of_class_[std::size_t(row.collision_class.value_or(CollisionClass::unknown))];
        if (row.change) ++of_change_[std::size_t(*row.change)];
        kept_.push_back({severity_of(row), rows_++, rows.pairs[i], json_row(row)});
        if (kept_.size() == 2 * max_rows) keep_worst();
    }
}

/// Drops all rows except the max_rows worst ones.
void HtmlReport::keep_worst() {
    if (kept_.size() <= max_rows) return;
    const auto is_worse = [](const Row& x, const Row& y) {
        return x.severity != y.severity ? x.severity > y.severity : x.number < y.number;
    };
    std::nth_element(kept_.begin(), kept_.begin() + max_rows, kept_.end(), is_worse);
    kept_.resize(max_rows);
}

void HtmlReport::write_rows() {
    keep_worst();
    std::sort(kept_.begin(), kept_.end(), [](const Row& x, const Row& y) { return x.number < y.number; });
    begin_list("rows");
    for (const Row& row : kept_) {
        named_[0][row.pair.a] = true;
        named_[scene_.join ? 1 : 0][row.pair.b] = true;
        separate();
        out_->write(row.json);
    }
    end_list();
}

void HtmlReport::write_gone(std::span<const std::string_view> lines) {
    of_change_[std::size_t(Change::gone)] = lines.size();
    for (const std::string_view line : lines.first(std::min<std::size_t>(lines.size(), max_rows))) {
        const nlohmann::json old = parse_json(line, "older result");
        gone_.push_back(script_json(gone_json(read_collision({old, "older result"}))));
    }
}

void HtmlReport::write_gone_rows() {
    begin_list("gone");
    for (const std::string& row : gone_) {
        separate();
        out_->write(row);
    }
    end_list();
}

void HtmlReport::write_objects() {
    TextNumbers words;
    begin_list("objects");
    for (std::size_t set = 0; set < (scene_.join ? 2 : 1); ++set) {
        separate();
        write_object_list(set, words);
    }
    end_list();
    begin_list("words");
    for (const std::string_view word : words.texts()) {
        separate();
        out_->write(script_json(json_string(word)));
    }
    end_list();
}

void HtmlReport::write_object_list(std::size_t set, TextNumbers& words) {
    const Boxes& boxes = set == 0 ? scene_.a : scene_.b;
    const ObjectNames& names = set == 0 ? scene_.form.names.a : scene_.form.names.b;
    const bool detailed = names.details != nullptr && !names.details->empty();
    out_->write("[");
    bool begun = false;
    for (std::size_t i = 0; i < named_[set].size(); ++i) {
        if (!named_[set][i]) continue;
        const auto object = std::uint32_t(i);
        std::string text = fmt::format("{}[{},{},{}", begun ? ",\n" : "", i,
                                       script_json(json_string(name_of(names, object))), json_box(boxes, i));
        for (const Detail detail : all_details) {
            if (detailed) text += fmt::format(",{}", words.of(names.detail(object, detail)));
        }
        out_->write(text + ']');
        begun = true;
    }
    out_->write("]");
}

/// Writes the boxes of the objects without a row. If there are more than max_others, only one in `stride` of them is written.
void HtmlReport::write_others() {
    for (const auto& set : named_) others_ += std::uint64_t(std::count(set.begin(), set.end(), false));
    const std::uint64_t stride = others_ / max_others + 1;
    std::uint64_t number = 0;
    begin_list("others");
    for (std::size_t set = 0; set < 2; ++set) {
        for (std::size_t i = 0; i < named_[set].size(); ++i) {
            if (named_[set][i] || number++ % stride != 0) continue;
            separate();
            out_->write(fmt::format("[{}]", json_box(set == 0 ? scene_.a : scene_.b, i)));
            ++others_drawn_;
        }
    }
    end_list();
}

void HtmlReport::write_summary() {
    nlohmann::json facts = nlohmann::json::array();
    facts.push_back({"collisions", std::to_string(rows_)});
    for (std::size_t i = 1; i < of_class_.size(); ++i) {
        if (of_class_[i] > 0) facts.push_back({word_of(CollisionClass(i)), std::to_string(of_class_[i])});
    }
    for (std::size_t i = 0; scene_.form.changes && i < of_change_.size(); ++i) {
        facts.push_back({word_of(Change(i)), std::to_string(of_change_[i])});
    }
    for (const auto& [label, value] : facts_) facts.push_back({clean_text(label), clean_text(value)});
    nlohmann::json notes = nlohmann::json::array();
    for (const std::string& note : notes_) notes.push_back(clean_text(note));
    if (const std::uint64_t gone = of_change_[std::size_t(Change::gone)]; std::max(rows_, gone) > max_rows) {
        notes.push_back(fmt::format("The table has the worst {} of {} rows.", max_rows, std::max(rows_, gone)));
    }
    if (others_drawn_ < others_) {
        notes.push_back(
            fmt::format("The picture shows {} of the {} objects that are not in the table.", others_drawn_, others_));
    }
    const nlohmann::json summary = {{"title", clean_text(scene_.title)},
                                    {"join", scene_.join},
                                    {"facts", facts},
                                    {"notes", notes},
                                    {"up", scene_.space.up == UpAxis::y ? 1 : 2},
                                    {"unit", scene_.space.unit},
                                    {"first", named_[0].size()}};
    out_->write("<script type=\"application/json\" id=\"summary\">" + script_json(dump_json(summary)) + "</script>\n");
}

void HtmlReport::write_viewer() {
    const std::string page = viewer_ ? viewer_() : std::string();
    if (page.empty()) return;
    out_->write("<script type=\"application/octet-stream\" id=\"viewer\">");
    out_->write(page);
    out_->write("</script>\n");
}

void HtmlReport::finish() {
    write_rows();
    write_gone_rows();
    write_objects();
    write_others();
    write_summary();
    write_viewer();
    out_->write(report_page.substr(report_page.find(data_mark) + data_mark.size()));
    out_->commit();
}

}  // namespace octopair::io
