#include "collisions.hpp"

#include "arrays.hpp"

namespace octopair::python {

void CollisionColumns::append(const Batch& batch) {
    static const Finding none;
    const auto findings = batch.findings();
    for (std::size_t i = 0; i < batch.pairs().size(); ++i) {
        pairs_.push_back(batch.pairs()[i]);
        append(findings.empty() ? none : findings[i]);
    }
}

void CollisionColumns::append(const Finding& finding) {
    classes_.push_back(std::uint8_t(finding.collision_class));
    distances_.push_back(finding.distance);
    nearest_.push_back(finding.nearest);
    depths_.push_back(finding.depth);
    depth_kinds_.push_back(std::uint8_t(finding.depth_kind));
    depths_at_most_.push_back(finding.depth_at_most);
    thicknesses_.push_back(finding.thickness);
    thickness_kinds_.push_back(std::uint8_t(finding.thickness_kind));
    open_.push_back(finding.open);
    times_.push_back(finding.time);
    more_contacts_.push_back(finding.more_contacts ? 1 : 0);
    notes_.push_back(finding.note);
    for (const Contact& contact : finding.contacts) {
        points_.push_back(contact.point);
        normals_.push_back(contact.normal);
        contact_depths_.push_back(contact.depth);
        features_.push_back({contact.feature_a, contact.feature_b});
    }
    offsets_.push_back(std::int64_t(points_.size()));
}

py::dict CollisionColumns::take() {
    static_assert(sizeof(bool) == 1);
    CollisionColumns taken = std::exchange(*this, {});
    py::dict columns;
    columns["pairs"] = array_of<std::uint32_t>(std::move(taken.pairs_), {2});
    columns["class_codes"] = array_of<std::uint8_t>(std::move(taken.classes_));
    columns["distance"] = array_of<double>(std::move(taken.distances_));
    columns["nearest"] = array_of<double>(std::move(taken.nearest_), {2, 3});
    columns["depth"] = array_of<double>(std::move(taken.depths_));
    columns["depth_kind"] = array_of<std::uint8_t>(std::move(taken.depth_kinds_));
    columns["depth_at_most"] = array_of<double>(std::move(taken.depths_at_most_));
    columns["thickness"] = array_of<double>(std::move(taken.thicknesses_));
    columns["thickness_kind"] = array_of<std::uint8_t>(std::move(taken.thickness_kinds_));
    columns["open"] = array_of<bool>(std::move(taken.open_), {2});
    columns["time"] = array_of<double>(std::move(taken.times_));
    columns["more_contacts"] = array_of<bool>(std::move(taken.more_contacts_));
    columns["note"] = array_of<std::uint64_t>(std::move(taken.notes_));
    columns["contact_offsets"] = array_of<std::int64_t>(std::move(taken.offsets_));
    columns["contact_points"] = array_of<double>(std::move(taken.points_), {3});
    columns["contact_normals"] = array_of<double>(std::move(taken.normals_), {3});
    columns["contact_depths"] = array_of<double>(std::move(taken.contact_depths_));
    columns["contact_features"] = array_of<std::uint32_t>(std::move(taken.features_), {2});
    return columns;
}

}  // namespace octopair::python
