// Pipeline and its filters.
#include <deque>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "arrays.hpp"
#include "bindings.hpp"
#include "call.hpp"
#include "collisions.hpp"
#include "engines.hpp"
#include "octopair/error.hpp"
#include "octopair/filters.hpp"
#include "shapes.hpp"

namespace octopair::python {

namespace {

/// Calls a Python function with the columns of a whole batch. The function returns a bool per pair.
class CallableFilter final : public Filter {
public:
    /// `turns`: those of the call that runs the filter.
    CallableFilter(std::string name, py::function keep, const std::vector<Turn*>& turns)
        : name_(std::move(name)), keep_(std::move(keep)), turns_(turns) {}
    CallableFilter(const CallableFilter&) = delete;
    CallableFilter& operator=(const CallableFilter&) = delete;
    ~CallableFilter() override {
        try {
            const Locked locked;
            keep_ = py::function();
        } catch (const Error&) {
            keep_.release();  // the interpreter ends
        }
    }

    std::string_view name() const override { return name_; }
    /// A call of Python takes as long as hundreds of pairs.
    std::size_t least_batch() const override { return 256; }
    void apply(Batch& batch) const override {
        CollisionColumns columns;
        columns.append(batch);
        std::vector<std::uint32_t> kept;
        {
            const Locked locked;
            const Callback callback(turns_);
            const py::object answer = keep_(columns.take());
            const auto mask = rows_of<bool>(answer.cast<py::array>());
            if (mask.size() != batch.pairs().size()) throw py::value_error("a filter must return a bool for each pair");
            for (std::size_t i = 0; i < mask.size(); ++i) {
                if (mask[i]) kept.push_back(std::uint32_t(i));
            }
        }
        batch.keep_these(kept);
    }

private:
    std::string name_;
    py::function keep_;
    const std::vector<Turn*>& turns_;
};

/// Numbers of objects that a filter has shapes for.
struct ShapeCounts {
    std::string filter;
    std::uint64_t first, second;
};

/// A pipeline, and references to the arrays of its filters.
class PythonPipeline {
public:
    explicit PythonPipeline(unsigned threads) : pipeline_(new Pipeline(threads)) {}

    void add_callable(const std::string& name, const py::function& keep) {
        add(std::make_unique<CallableFilter>(name, keep, turns_));
    }
    /// Groups and masks of the first set, and of the second or None.
    void add_groups(const py::tuple& first, const py::object& second) {
        keep(first, second);
        std::optional<GroupMasks> other;
        if (!second.is_none()) other = masks_of(second.cast<py::tuple>());
        add(make_group_filter(masks_of(first), other));
    }
    void add_ignored_pairs(const py::array& pairs, bool join) {
        const auto rows = rows_of<Pair, std::uint32_t>(pairs);
        add(make_ignored_pairs_filter({rows.begin(), rows.end()}, join));
    }
    /// Rules are pairs of patterns.
    void add_names(std::vector<std::string> first, const std::vector<std::pair<std::string, std::string>>& rules,
                   std::optional<std::vector<std::string>> second) {
        std::vector<NameRule> patterns;
        for (const auto& [a, b] : rules) patterns.push_back({a, b});
        std::optional<std::span<const std::string>> other;
        names_.push_back(std::move(first));
        const std::span<const std::string> names = names_.back();
        if (second) {
            names_.push_back(std::move(*second));
            other = names_.back();
        }
        add(make_name_filter(names, std::move(patterns), other));
    }
    /// Columns are lists of texts, one per object. A rule is two lists with a pattern or None for each column.
    void add_columns(const std::vector<std::vector<std::string>>& first,
                     const std::vector<std::pair<ColumnPatterns, ColumnPatterns>>& rules,
                     const std::optional<std::vector<std::vector<std::string>>>& second) {
        std::vector<ColumnRule> patterns;
        for (const auto& [a, b] : rules) patterns.push_back({a, b});
        const TextColumns here = texts_of(first);
        std::optional<TextColumns> there;
        if (second) there = texts_of(*second);
        add(make_column_filter(here, patterns, there ? &*there : nullptr));
    }
    void add_parents(const py::array& first, const py::object& second) {
        keep(first, second);
        std::optional<std::span<const std::uint32_t>> other;
        if (!second.is_none()) other = rows_of<std::uint32_t>(second.cast<py::array>());
        add(make_parent_filter(rows_of<std::uint32_t>(first), other));
    }
    /// `kind` is the name of a filter of shapes. `options` is (margin, max_contacts, tolerance, duplicate_tolerance).
    void add_shapes(const std::string& kind, const py::object& first, const py::object& second,
                    const py::tuple& options) {
        keep(first, second);
        const ShapedObjects& objects = first.cast<const PythonShapes&>().objects();
        const ShapedObjects* other = second.is_none() ? nullptr : &second.cast<const PythonShapes&>().objects();
        const ExactOptions exact{options[0].cast<double>(), options[1].cast<std::uint32_t>(), options[2].cast<double>(),
                                 options[3].cast<std::optional<double>>()};
        if (kind == "bounding spheres") add(make_sphere_filter(objects, exact.margin, other));
        if (kind == "oriented boxes") add(make_oriented_box_filter(objects, exact.margin, other));
        if (kind == "exact object") add(make_exact_object_filter(objects, exact, other));
        if (kind == "exact feature") add(make_exact_feature_filter(objects, exact, other));
        shapes_.push_back({kind, objects.size(), (other == nullptr ? objects : *other).size()});
    }
    void add_depth(double least) { add(make_depth_filter(least)); }
    /// Sets are (triangles (n, 9), owners or None). `options` is (adjacent, margin, features, tolerance).
    void add_triangles(const py::tuple& first, const py::object& second, const py::tuple& options) {
        keep(first, second);
        const TriangleOptions triangles{AdjacentTriangles(options[0].cast<int>()), options[1].cast<double>(),
                                        options[2].cast<bool>(), options[3].cast<double>(), 0};
        std::optional<TriangleSet> other;
        if (!second.is_none()) other = triangles_of(second.cast<py::tuple>());
        add(make_triangle_filter(triangles_of(first), triangles, other ? &*other : nullptr));
    }

    /// Returns (columns, summary). With a sink, the sink receives the columns of each batch, and the result has none.
    py::tuple run(PythonEngine& engine, const ArrayInput& input, const Options& options, const py::tuple& callables) {
        const Turn::Holder turn(turn_), engine_turn(engine.turn());
        turns_ = {&turn_, &engine.turn()};
        check_sizes(input.input());
        const py::object progress = callables[0], sink = callables[1];
        CollisionColumns columns;
        PipelineSummary summary;
        // A repetition would pass batches to the sink twice.
        call({.progress = progress, .repeatable = false}, [&](const std::stop_token& stop, ProgressValue& value) {
            summary = pipeline_->run(
                engine.engine(), input.input(), [&](const Batch& batch) { receive(batch, columns, sink); },
                with_progress(options, progress, value), stop);
        });
        return py::make_tuple(columns.take(), summary_of(summary));
    }
    py::tuple count(PythonEngine& engine, const ArrayInput& input, const Options& options, const py::object& progress) {
        const Turn::Holder turn(turn_), engine_turn(engine.turn());
        turns_ = {&turn_, &engine.turn()};
        check_sizes(input.input());
        PipelineSummary summary;
        call({.progress = progress, .repeatable = false}, [&](const std::stop_token& stop, ProgressValue& value) {
            summary = pipeline_->run(engine.engine(), input.input(), {}, with_progress(options, progress, value), stop);
        });
        return summary_of(summary);
    }

private:
    static GroupMasks masks_of(const py::tuple& columns) {
        return {rows_of<std::uint32_t>(columns[0].cast<py::array>()),
                rows_of<std::uint32_t>(columns[1].cast<py::array>())};
    }
    /// Borrows `columns`.
    static TextColumns texts_of(const std::vector<std::vector<std::string>>& columns) {
        return {columns.empty() ? 0 : columns[0].size(),
                [&columns](std::uint32_t object, std::size_t column) -> std::string_view {
                    return columns[column][object];
                }};
    }
    static TriangleSet triangles_of(const py::tuple& set) {
        return {rows_of<Triangle3d, double>(set[0].cast<py::array>()), optional_rows_of<std::uint32_t>(set[1])};
    }
    void receive(const Batch& batch, CollisionColumns& columns, const py::object& sink) const {
        columns.append(batch);
        if (sink.is_none()) return;
        const Locked locked;
        const Callback callback(turns_);
        sink(columns.take());
    }
    static py::tuple summary_of(const PipelineSummary& summary) {
        py::list filters;
        for (const FilterCounts& filter : summary.filters) {
            filters.append(py::make_tuple(filter.name, filter.in, filter.out, filter.seconds, filter.undecided));
        }
        return py::make_tuple(summary.collisions, py::tuple(py::cast(summary.of_class)), summary.truncated,
                              summary.seconds, summary_tuple(summary.search), filters);
    }

    void add(std::unique_ptr<Filter> filter) {
        const Turn::Holder turn(turn_);
        pipeline_->add(std::move(filter));
    }
    /// Filters of shapes do not check the indices of pairs. Throws: Error{bad_input} for objects without shapes.
    void check_sizes(const Input& input) const {
        const std::uint64_t first = input.first.size(), second = (input.second ? *input.second : input.first).size();
        for (const ShapeCounts& shapes : shapes_) {
            if (first <= shapes.first && second <= shapes.second) continue;
            throw Error(ErrorCode::bad_input, "filter '" + shapes.filter + "': there are boxes of " +
                                                  std::to_string(first) +
                                                  (input.second ? " and " + std::to_string(second) : "") +
                                                  " objects, but shapes of " + std::to_string(shapes.first) +
                                                  (input.second ? " and " + std::to_string(shapes.second) : ""));
        }
    }

    void keep(const py::object& first, const py::object& second) {
        kept_.append(first);
        kept_.append(second);
    }

    py::list kept_;
    std::deque<std::vector<std::string>> names_;
    std::vector<ShapeCounts> shapes_;
    std::vector<Turn*> turns_;  // of the call that runs
    Turn turn_;
    std::unique_ptr<Pipeline, ReleasedDelete> pipeline_;  // last: its filters use the other members
};

}  // namespace

void bind_pipeline(py::module_& module) {
    py::class_<PythonPipeline>(module, "Pipeline")
        .def(py::init<unsigned>(), py::arg("threads") = 0)
        .def("add_callable", &PythonPipeline::add_callable, py::arg("name"), py::arg("keep"))
        .def("add_groups", &PythonPipeline::add_groups, py::arg("first"), py::arg("second"))
        .def("add_ignored_pairs", &PythonPipeline::add_ignored_pairs, py::arg("pairs"), py::arg("join"))
        .def("add_names", &PythonPipeline::add_names, py::arg("first"), py::arg("rules"), py::arg("second"))
        .def("add_columns", &PythonPipeline::add_columns, py::arg("first"), py::arg("rules"), py::arg("second"))
        .def("add_parents", &PythonPipeline::add_parents, py::arg("first"), py::arg("second"))
        .def("add_shapes", &PythonPipeline::add_shapes, py::arg("kind"), py::arg("first"), py::arg("second"),
             py::arg("options"))
        .def("add_depth", &PythonPipeline::add_depth, py::arg("least"))
        .def("add_triangles", &PythonPipeline::add_triangles, py::arg("first"), py::arg("second"), py::arg("options"))
        .def("run", &PythonPipeline::run, py::arg("engine"), py::arg("input"), py::arg("options"), py::arg("callables"))
        .def("count", &PythonPipeline::count, py::arg("engine"), py::arg("input"), py::arg("options"),
             py::arg("progress"));
}

}  // namespace octopair::python
