// A report of collisions for people: one page that needs nothing else, with a summary, a table that sorts and filters, and
// the boxes of the objects from three sides.
//
// The page is report_page.html; what is written into it is JSON in <script> elements, in which "<" is always escaped, so no
// name can be anything but text. Rows beyond `most_rows` are counted and left out, and of objects that no row names at most
// `most_others` are drawn; the page says so.
#pragma once

#include <array>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "io/results/collision_writer.hpp"
#include "octopair/objects.hpp"

namespace octopair::io {

/// What the rows are about. Boxes and names are borrowed, and must be there until finish().
struct ReportScene {
    std::string title;  ///< above the page, as the inputs' names
    CollisionForm form;
    Boxes a, b;  ///< b: of a join
    bool join = false;
};

class HtmlReport final : public CollisionWriter {
public:
    static constexpr std::uint64_t most_rows = 200'000, most_others = 20'000;

    HtmlReport(std::unique_ptr<OutputStream> out, ReportScene scene);

    void write(const CollisionRows& rows) override;
    void write_gone(std::span<const std::string_view> lines) override;
    /// For the summary: "time", "3.2 s". Behind the number of collisions.
    void add_fact(std::string label, std::string value) { facts_.emplace_back(std::move(label), std::move(value)); }
    void finish() override;

private:
    void write_row(Pair pair, const Finding& finding, const Change* change);
    void begin_list(std::string_view id);
    void end_list();
    void separate();
    void write_objects();
    void write_object_list(std::size_t set);
    void write_others();
    void write_summary();

    std::unique_ptr<OutputStream> out_;
    ReportScene scene_;
    std::vector<std::pair<std::string, std::string>> facts_;
    std::array<std::vector<bool>, 2> named_;  // of each set: the objects that rows name
    std::array<std::uint64_t, 6> of_class_ = {};
    std::array<std::uint64_t, 3> of_change_ = {};
    std::uint64_t rows_ = 0, others_ = 0, others_drawn_ = 0;
    bool first_ = true;  // of a list
    bool rows_ended_ = false;
};

}  // namespace octopair::io
