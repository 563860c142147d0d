#include "io/results/html_report.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "io/json/json_fields.hpp"
#include "io/json/json_text.hpp"
#include "io/results/report_page.hpp"

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

std::string label_of(const ObjectNames& names, std::uint32_t object) {
    const std::string name(names.of(object));
    return names.owners.empty() ? name : fmt::format("{}, triangle {}", name, names.triangle(object));
}

/// Returns a point where the objects of a pair meet or are nearest, or "null" if none is known.
std::string json_place(const Finding& finding, bool features) {
    const bool clear = finding.collision_class == CollisionClass::clearance;
    if (!clear && (!features || finding.contacts.empty())) return "null";
    const Point3d& at = clear ? finding.nearest[0] : finding.contacts.front().point;
    return fmt::format("[{},{},{}]", json_number(at[0]), json_number(at[1]), json_number(at[2]));
}

/// Returns the label of one object of a row of the baseline. `side` is "a" or "b".
nlohmann::json old_label(const nlohmann::json& row, const std::string& side) {
    const std::string name = row.value(side + "_name", "#" + dump_json(row.at(side)));
    const auto triangle = row.find(side + "_triangle");
    return triangle == row.end() ? name : name + ", triangle " + dump_json(*triangle);
}

nlohmann::json old_number(const nlohmann::json& row, const char* key) {
    const auto value = row.find(key);
    return value != row.end() && value->is_number() ? *value : nlohmann::json();
}

}  // namespace

HtmlReport::HtmlReport(std::unique_ptr<OutputStream> out, ReportScene scene)
    : out_(std::move(out)), scene_(std::move(scene)) {
    named_[0].resize(std::size_t(size_of(scene_.a)));
    named_[1].resize(std::size_t(scene_.join ? size_of(scene_.b) : 0));
    out_->write(report_page.substr(0, report_page.find(data_mark)));
    begin_list("rows");
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
        const Finding finding = rows.findings.empty() ? Finding() : rows.findings[i];
        ++of_class_[std::size_t(finding.collision_class)];
        if (!rows.changes.empty()) ++of_change_[std::size_t(rows.changes[i])];
        if (rows_++ >= max_rows) continue;
        named_[0][rows.pairs[i].a] = true;
        named_[scene_.join ? 1 : 0][rows.pairs[i].b] = true;
        write_row(rows.pairs[i], finding, rows.changes.empty() ? nullptr : &rows.changes[i]);
    }
}

void HtmlReport::write_row(Pair pair, const Finding& finding, const Change* change) {
    const CollisionClass what = finding.collision_class;
    const bool known = what != CollisionClass::unknown, features = scene_.form.features && meet(what);
    const bool deep = features && finding.depth_kind != DepthKind::unknown;
    const auto if_known = [](bool is, auto value) { return is ? json_number(double(value)) : std::string("null"); };
    separate();
    out_->write(fmt::format(
        "[{},{},{},{},{},{},{},{},{},{},{}]", pair.a, pair.b, int(what),
        change == nullptr ? "null" : std::to_string(int(*change)), if_known(known && !meet(what), finding.distance),
        if_known(deep, finding.depth), if_known(known && scene_.form.times, finding.time),
        if_known(features, finding.contacts.size()), int(features && finding.more_contacts),
        json_place(finding, scene_.form.features), int(deep && finding.depth_kind == DepthKind::at_least)));
}

void HtmlReport::write_gone(std::span<const std::string_view> lines) {
    end_list();
    rows_ended_ = true;
    begin_list("gone");
    of_change_[std::size_t(Change::gone)] = lines.size();
    for (const std::string_view line : lines.first(std::min<std::size_t>(lines.size(), max_rows))) {
        const nlohmann::json old = parse_json(line, "older result");
        const auto contacts = old.find("contacts"), kind = old.find("class");
        const nlohmann::json row = {old_label(old, "a"),
                                    old_label(old, "b"),
                                    kind != old.end() && kind->is_string() ? *kind : nlohmann::json(""),
                                    old_number(old, "distance"),
                                    old_number(old, "depth"),
                                    old_number(old, "time"),
                                    contacts == old.end() ? nlohmann::json() : nlohmann::json(contacts->size())};
        separate();
        out_->write(script_json(dump_json(row)));
    }
    end_list();
}

void HtmlReport::write_objects() {
    begin_list("objects");
    for (std::size_t set = 0; set < (scene_.join ? 2 : 1); ++set) {
        separate();
        write_object_list(set);
    }
    end_list();
}

void HtmlReport::write_object_list(std::size_t set) {
    const Boxes& boxes = set == 0 ? scene_.a : scene_.b;
    const ObjectNames& names = set == 0 ? scene_.form.names.a : scene_.form.names.b;
    out_->write("[");
    bool begun = false;
    for (std::size_t i = 0; i < named_[set].size(); ++i) {
        if (!named_[set][i]) continue;
        out_->write(fmt::format("{}[{},{},{}]", begun ? ",\n" : "", i,
                                script_json(json_string(label_of(names, std::uint32_t(i)))), json_box(boxes, i)));
        begun = true;
    }
    out_->write("]");
}

/// Writes the boxes of the objects without a row. If there are more than max_others, only every stride-th one is written.
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
    if (const std::uint64_t gone = of_change_[std::size_t(Change::gone)]; std::max(rows_, gone) > max_rows) {
        notes.push_back(fmt::format("The table has the first {} rows of {}.", max_rows, std::max(rows_, gone)));
    }
    if (others_drawn_ < others_) {
        notes.push_back(
            fmt::format("The picture shows {} of the {} objects that are not in the table.", others_drawn_, others_));
    }
    const nlohmann::json summary = {
        {"title", clean_text(scene_.title)}, {"join", scene_.join}, {"facts", facts}, {"notes", notes}};
    out_->write("<script type=\"application/json\" id=\"summary\">" + script_json(dump_json(summary)) + "</script>\n");
}

void HtmlReport::finish() {
    if (!rows_ended_) write_gone({});
    write_objects();
    write_others();
    write_summary();
    out_->write(report_page.substr(report_page.find(data_mark) + data_mark.size()));
    out_->commit();
}

}  // namespace octopair::io
