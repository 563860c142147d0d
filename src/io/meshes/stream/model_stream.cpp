#include "io/meshes/stream/model_stream.hpp"

#include <algorithm>
#include <cmath>
#include <deque>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "io/files/failure.hpp"
#include "io/files/input_file.hpp"
#include "io/meshes/placed_meshes.hpp"
#include "io/meshes/stream/stream_records.hpp"

namespace octopair::io {

namespace {

/// Returns a text as one line that a terminal shows as it is.
std::string line_of(std::string text) {
    std::replace_if(
        text.begin(), text.end(), [](char c) { return (c >= 0 && c < ' ') || c == 127; }, ' ');
    return text;
}

/// StreamedModel collects the records of a stream, and makes a scene of them.
class StreamedModel {
public:
    StreamedModel(StreamRecords& records, ReadBudget& budget, ElementInHand& in_hand)
        : records_(records), budget_(budget), in_hand_(in_hand) {
        placed_.noun = "element";
    }

    void read() {
        while (!ended_) read_record(records_.next());
        records_.check_at_end();
    }

    LoadedScene scene(const SceneContent& content) {
        LoadedScene scene = scene_of(placed_, content, budget_);
        ObjectDetails details;
        DetailsBuilder builder(details);
        for (const DetailTexts& texts : details_) builder.add(texts);
        (scene.triangles ? scene.triangles->owner_details : scene.details) = std::move(details);
        if (content.objects == MeshObjects::node) scene.relations = std::move(relations_);
        scene.space.up = up_;
        scene.project = std::move(project_);
        scene.warnings = std::move(warnings_);
        if (const std::string lost = elements_.lost_text(); !lost.empty())
            scene.warnings.push_back(budget_.path() + ": " + lost);
        scene.elements = std::move(elements_);
        for (const TypeCount& type : scene.elements.left_out)
            scene.not_read.push_back(fmt::format("{} ({})", type.type, type.count));
        scene.chord = UnitChange(placed_.unit, content.unit)(error_);
        return scene;
    }

private:
    void read_record(StreamRecord kind) {
        if (!has_model_ && kind != StreamRecord::model && kind != StreamRecord::failure)
            records_.refuse("does not begin with the record of the model");
        switch (kind) {
            case StreamRecord::model:
                return read_model();
            case StreamRecord::shape:
                return read_shape();
            case StreamRecord::instance:
                return read_instance();
            case StreamRecord::element:
                in_hand_ = line_of(records_.text());
                return records_.finish();
            case StreamRecord::warning:
                budget_.charge(1, sizeof(std::string) + budget_.path().size());
                warnings_.push_back(budget_.path() + ": " + line_of(records_.text()));
                return records_.finish();
            case StreamRecord::failure:
                records_.refuse(line_of(records_.text()));
            case StreamRecord::end:
                return read_end();
        }
        // Later versions may have other records, which say what nobody must know.
    }

    void read_model() {
        if (std::exchange(has_model_, true)) records_.refuse("has a second record of the model");
        placed_.unit = records_.text();
        if (!placed_.unit.empty() && !metres_of(placed_.unit))
            records_.refuse(fmt::format("has the unknown unit '{}'", shown(placed_.unit)));
        const std::string up = records_.text();
        if (up != "y" && up != "z" && !up.empty()) records_.refuse(fmt::format("has the unknown axis '{}'", shown(up)));
        up_ = up == "y" ? UpAxis::y : up == "z" ? UpAxis::z : UpAxis::unknown;
        project_ = records_.text();
        scope_ = (project_.empty() ? budget_.path() : project_) + '/';
        records_.finish();
    }

    void read_shape() {
        const double error = records_.real();
        if (!(error >= 0) || !std::isfinite(error)) records_.refuse("has a shape whose error is no length");
        errors_.push_back(error);
        const std::uint32_t vertices = records_.number32(), triangles = records_.number32();
        SharedMesh& mesh = placed_.meshes.emplace_back();
        mesh.triangles.vertices = records_.array<Point3d>(vertices);
        mesh.triangles.triangles = records_.array<std::array<std::uint32_t, 3>>(triangles);
        records_.finish();
        const std::string name = fmt::format("shape {}", placed_.meshes.size() - 1);
        for (const Point3d& vertex : mesh.triangles.vertices) {
            if (!std::all_of(vertex.begin(), vertex.end(), [](double at) { return std::isfinite(at); }))
                records_.refuse(fmt::format("has a vertex in {} that is not finite", name));
        }
        for (const auto& corners : mesh.triangles.triangles) {
            if (*std::max_element(corners.begin(), corners.end()) >= vertices)
                records_.refuse(fmt::format("has a triangle in {} with a vertex beyond its {}", name, vertices));
        }
        if (triangles == 0) records_.refuse(fmt::format("has no triangles in {}", name));
        const auto corners = std::span(mesh.triangles.triangles.front().data(), 3 * mesh.triangles.triangles.size());
        remove_unused_vertices(mesh.triangles.vertices, corners);
    }

    void read_instance() {
        PlacedMesh object;
        object.mesh = records_.number32();
        if (object.mesh >= placed_.meshes.size())
            records_.refuse(fmt::format("has an instance of shape {}, which it has not", object.mesh));
        budget_.charge(1, sizeof(PlacedMesh) + sizeof(DetailTexts) + sizeof(std::string));
        object.pose = read_pose();
        error_ = std::max(error_, errors_[object.mesh] * object.pose.largest_scale());
        object.name = records_.text();
        DetailTexts& texts = details_.emplace_back();
        for (const Detail detail :
             {Detail::label, Detail::type, Detail::id, Detail::parent, Detail::level, Detail::material})
            texts[std::size_t(detail)] = records_.text();
        object.label = texts[std::size_t(Detail::label)];
        object.parent_label = texts[std::size_t(Detail::parent)];
        read_relations(texts[std::size_t(Detail::id)]);
        records_.finish();
        const std::string above = object.name.substr(0, object.name.rfind('/'));
        object.parent = parents_.try_emplace(above, parents_.size()).first->second;
        placed_.objects.push_back(std::move(object));
    }

    BoundedPose read_pose() {
        std::array<std::array<double, 4>, 4> rows;
        for (auto& row : rows) {
            for (double& number : row) {
                number = records_.real();
                if (!std::isfinite(number)) records_.refuse("has an instance whose transform is not finite");
            }
        }
        if (rows[3] != std::array<double, 4>{0, 0, 0, 1})
            records_.refuse("has an instance whose transform does not end with the row 0 0 0 1");
        return BoundedPose({rows[0], rows[1], rows[2]});
    }

    /// Reads the ids of the host, the assembly and the systems of the element with an id.
    void read_relations(const std::string& id) {
        const std::string host = records_.text(), assembly = records_.text();
        std::vector<std::string> systems;
        for (std::uint32_t left = records_.number32(); left > 0; --left) {
            budget_.charge(1, sizeof(std::string));
            systems.push_back(records_.text());
        }
        const std::uint32_t own = id.empty() ? 0 : keys_.of(scope_ + id);
        relations_.elements.push_back(own);
        if (own == 0) return;
        const auto link = [&](Relation relation, const std::string& to) {
            const Link added{own, keys_.of(scope_ + to)};
            auto& links = relations_.links[std::size_t(relation)];
            if (links.empty() || links.back() != added) links.push_back(added);
        };
        if (!host.empty()) link(Relation::fills, host);
        if (!assembly.empty()) link(Relation::assembly, assembly);
        for (const std::string& system : systems) link(Relation::system, system);
    }

    void read_end() {
        elements_.with_geometry = records_.number64();
        elements_.read = records_.number64();
        if (elements_.read > elements_.with_geometry) records_.refuse("has read more elements than there are");
        for (std::uint32_t left = records_.number32(); left > 0; --left) {
            LostElements lost{budget_.path(), records_.text(), records_.number64(), {}};
            lost.first = records_.text();
            elements_.lost.push_back(std::move(lost));
        }
        for (std::uint32_t left = records_.number32(); left > 0; --left) {
            TypeCount type{records_.text(), 0};
            type.count = records_.number64();
            elements_.left_out.push_back(std::move(type));
        }
        records_.finish();
        ended_ = true;
    }

    StreamRecords& records_;
    ReadBudget& budget_;
    ElementInHand& in_hand_;
    PlacedMeshes placed_;
    std::deque<DetailTexts> details_;  // of the objects; these borrow their labels
    ObjectRelations relations_;
    KeyNumbers keys_{relations_.keys};
    std::map<std::string, std::uint64_t> parents_;  // numbers of the paths above objects
    ElementCounts elements_;
    std::vector<std::string> warnings_;
    UpAxis up_ = UpAxis::unknown;
    std::string project_, scope_;
    std::vector<double> errors_;  // of the shapes, in their own coordinates
    double error_ = 0;            // greatest error in the world
    bool has_model_ = false, ended_ = false;
};

}  // namespace

LoadedScene read_model_stream(const ByteSource& source, const SceneContent& content, ReadBudget& budget,
                              ElementInHand& in_hand) {
    StreamRecords records(source, budget);
    StreamedModel model(records, budget, in_hand);
    model.read();
    return model.scene(content);
}

LoadedScene read_model_stream_file(const std::string& path, const SceneContent& content, const std::stop_token& stop) {
    const InputFile file(path);
    ReadBudget budget(path, stop);
    budget.add_file(file.size());
    std::uint64_t at = 0;
    const ByteSource source = [&](std::span<std::byte> bytes) {
        const auto size = std::size_t(std::min<std::uint64_t>(bytes.size(), file.size() - at));
        file.read(at, bytes.first(size));
        at += size;
        return size;
    };
    ElementInHand in_hand;
    LoadedScene scene = read_model_stream(source, content, budget, in_hand);
    file.check_unchanged();
    return scene;
}

}  // namespace octopair::io
