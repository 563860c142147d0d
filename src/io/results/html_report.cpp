#include "io/results/html_report.hpp"

#include <algorithm>
#include <limits>
#include <unordered_map>

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

std::string name_of(const ObjectNames& names, std::uint32_t object) {
    const std::string name(names.of(object));
    return names.owners.empty() ? name : fmt::format("{}, triangle {}", name, names.triangle(object));
}

/// Returns how bad a collision is, for the order of the rows.
double severity_of(const Finding& finding, bool deep) {
    constexpr double worst = std::numeric_limits<double>::infinity();
    if (finding.collision_class == CollisionClass::duplicate) return worst;
    if (finding.collision_class == CollisionClass::clearance) return -finding.distance;
    return deep ? finding.depth : 0;
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

nlohmann::json old_text(const nlohmann::json& row, const char* key) {
    const auto value = row.find(key);
    return value != row.end() && value->is_string() ? *value : nlohmann::json("");
}

nlohmann::json old_number(const nlohmann::json& row, const char* key) {
    const auto value = row.find(key);
    return value != row.end() && value->is_number() ? *value : nlohmann::json();
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
        const Finding finding = rows.findings.empty() ? Finding() : rows.findings[i];
        ++of_class_[std::size_t(finding.collision_class)];
        if (!rows.changes.empty()) ++of_change_[std::size_t(rows.changes[i])];
        kept_.push_back({severity_of(finding, has_depth(finding)), rows_++, rows.pairs[i],
                         json_row(rows.pairs[i], finding, rows.changes.empty() ? nullptr : &rows.changes[i])});
        if (kept_.size() == 2 * max_rows) keep_worst();
    }
}

bool HtmlReport::has_depth(const Finding& finding) const {
    return scene_.form.features && meet(finding.collision_class) && finding.depth_kind != DepthKind::unknown;
}

/// Drops all rows but the worst max_rows.
void HtmlReport::keep_worst() {
    if (kept_.size() <= max_rows) return;
    const auto is_worse = [](const Row& x, const Row& y) {
        return x.severity != y.severity ? x.severity > y.severity : x.number < y.number;
    };
    std::nth_element(kept_.begin(), kept_.begin() + max_rows, kept_.end(), is_worse);
    kept_.resize(max_rows);
}

std::string HtmlReport::json_row(Pair pair, const Finding& finding, const Change* change) const {
    const CollisionClass what = finding.collision_class;
    const bool known = what != CollisionClass::unknown, features = scene_.form.features && meet(what);
    const bool deep = has_depth(finding), bounded = deep && finding.depth_kind == DepthKind::at_least;
    const auto if_known = [](bool is, auto value) { return is ? json_number(double(value)) : std::string("null"); };
    return fmt::format("[{},{},{},{},{},{},{},{},{},{},{},{},{}]", pair.a, pair.b, int(what),
                       change == nullptr ? "null" : std::to_string(int(*change)),
                       if_known(known && !meet(what), finding.distance), if_known(deep, finding.depth),
                       if_known(known && scene_.form.times, finding.time), if_known(features, finding.contacts.size()),
                       int(features && finding.more_contacts), json_place(finding, scene_.form.features), int(bounded),
                       if_known(bounded, finding.depth_at_most), int(finding.open[0]) + 2 * int(finding.open[1]));
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
        const auto contacts = old.find("contacts"), kind = old.find("class");
        const nlohmann::json row = {old_label(old, "a"),
                                    old_label(old, "b"),
                                    kind != old.end() && kind->is_string() ? *kind : nlohmann::json(""),
                                    old_number(old, "distance"),
                                    old_number(old, "depth"),
                                    old_number(old, "time"),
                                    contacts == old.end() ? nlohmann::json() : nlohmann::json(contacts->size()),
                                    int(old.value("depth_kind", nlohmann::json()) == word_of(DepthKind::at_least)),
                                    old_text(old, "a_label"),
                                    old_text(old, "a_type"),
                                    old_text(old, "b_label"),
                                    old_text(old, "b_type")};
        gone_.push_back(script_json(dump_json(row)));
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
