// HtmlReport: a self-contained HTML page about the collisions of a result.
//
// - The page has a summary, a table that groups, sorts and filters, and drawings of the boxes from three sides. On the screen, the
//   viewer is in place of the drawings, if the build has the viewer.
// - The page is in the folder report_page. Its data are JSON in <script> elements. "<" is always escaped, so a name cannot become HTML.
// - The page has at most `max_rows` rows: the worst collisions, and of equally bad ones the first. The page states how many are left out.
//   Duplicates are the worst, then pairs by depth, then pairs by distance.
// - Rows are kept in memory until finish(): at most 2 * max_rows.
// - At most `max_others` objects without a row are drawn. The page says so.
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "io/formats/format_choice.hpp"
#include "io/results/collision_writer.hpp"
#include "octopair/objects.hpp"

namespace octopair::io {

/// The scene that the rows refer to. Boxes and names are borrowed. Requires: they exist until finish().
struct ReportScene {
    std::string title;  ///< title of the page, for example the names of the inputs
    CollisionForm form;
    Boxes a, b;  ///< boxes of the first set; in a join, b has those of the second set
    bool join = false;
    SceneSpace space = {};  ///< axes and unit of the coordinates; if the axis is unknown, z is up
};

/// The page of the folder report_page, with its style and its scripts. HtmlReport replaces the mark "@DATA@" with the data of a report.
extern const std::string_view report_page;

class TextNumbers;

class HtmlReport final : public CollisionWriter {
public:
    static constexpr std::uint64_t max_rows = 200'000, max_others = 20'000;

    HtmlReport(std::unique_ptr<OutputStream> out, ReportScene scene);

    void write(const CollisionRows& rows) override;
    void write_gone(std::span<const std::string_view> lines) override;
    /// Adds an entry to the summary, after the number of collisions. Example: "time", "3.2 s".
    void add_fact(std::string label, std::string value) { facts_.emplace_back(std::move(label), std::move(value)); }
    /// Sets a function that returns the page of the viewer with the scene, compressed by gzip and in base64; or an empty text. The report
    /// then shows it in place of the drawings. finish() calls the function.
    void set_viewer(std::function<std::string()> viewer) { viewer_ = std::move(viewer); }
    /// Adds a sentence to the notes at the head of the page.
    void add_note(std::string note) { notes_.push_back(std::move(note)); }
    void finish() override;

private:
    struct Row {
        double severity;
        std::uint64_t number;  // position in the result
        Pair pair;
        std::string json;
    };

    void keep_worst();
    void write_rows();
    void write_gone_rows();
    void begin_list(std::string_view id);
    void end_list();
    void separate();
    void write_objects();
    void write_object_list(std::size_t set, TextNumbers& words);
    void write_others();
    void write_summary();
    void write_viewer();

    std::unique_ptr<OutputStream> out_;
    ReportScene scene_;
    std::vector<std::pair<std::string, std::string>> facts_;
    std::vector<std::string> notes_;
    std::function<std::string()> viewer_;
    std::vector<Row> kept_;
    std::vector<std::string> gone_;
    std::array<std::vector<bool>, 2> named_;  // for each set and object: true if a row names the object
    std::array<std::uint64_t, 6> of_class_ = {};
    std::array<std::uint64_t, 3> of_change_ = {};
    std::uint64_t rows_ = 0, others_ = 0, others_drawn_ = 0;
    bool first_ = true;  // true before the first element of the current list
};

}  // namespace octopair::io
