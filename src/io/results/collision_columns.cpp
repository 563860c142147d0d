#include "io/results/collision_columns.hpp"

#include "io/results/collision_key.hpp"

namespace octopair::io {

namespace {

RecordedObject recorded(std::uint32_t object, const ObjectNames& names, bool files) {
    RecordedObject recorded{object, names.of(object)};
    if (files) recorded.file = names.source(object).path;
    for (const Detail detail : all_details) recorded.details[std::size_t(detail)] = names.detail(object, detail);
    if (!names.owners.empty()) recorded.triangle = names.triangle(object);
    return recorded;
}

/// Adds the content of a finding: for objects that are apart the distance, for others depth and contacts.
void add_finding(CollisionRecord& row, const Finding& finding, const CollisionForm& form) {
    const CollisionClass what = finding.collision_class;
    if (what == CollisionClass::unknown) return;
    row.collision_class = what;
    row.a.open = finding.open[0];
    row.b.open = finding.open[1];
    if (form.times) row.time = finding.time;
    if (what == CollisionClass::undecided) return;
    if (!meet(what)) {
        row.distance = finding.distance;
        row.nearest = finding.nearest;
        return;
    }
    if (!form.features) return;
    row.contacts = finding.contacts;
    row.more_contacts = finding.more_contacts;
    if (finding.thickness_kind != ThicknessKind::unknown) {
        row.thickness = finding.thickness;
        row.thickness_kind = finding.thickness_kind;
    }
    if (finding.depth_kind == DepthKind::unknown) return;
    row.depth = finding.depth;
    row.depth_kind = finding.depth_kind;
    if (finding.depth_kind == DepthKind::at_least) row.depth_at_most = finding.depth_at_most;
}

}  // namespace

CollisionRecord record_of(const CollisionRows& rows, std::size_t i, const CollisionForm& form) {
    const Pair pair = rows.pairs[i];
    CollisionRecord row{recorded(pair.a, form.names.a, form.files), recorded(pair.b, form.names.b, form.files)};
    row.key = collision_key(pair, form.names);
    if (!rows.changes.empty()) row.change = rows.changes[i];
    if (!rows.statuses.empty()) {
        row.status = rows.statuses[i].status;
        row.comment = rows.statuses[i].comment;
    }
    if (!rows.findings.empty()) add_finding(row, rows.findings[i], form);
    return row;
}

Finding finding_of(const CollisionRecord& row) {
    Finding finding;
    finding.collision_class = row.collision_class.value_or(CollisionClass::unknown);
    finding.distance = row.distance.value_or(0);
    finding.nearest = row.nearest.value_or(NearestPoints());
    finding.depth = row.depth.value_or(0);
    finding.depth_kind = row.depth_kind.value_or(DepthKind::unknown);
    finding.depth_at_most = row.depth_at_most.value_or(0);
    finding.thickness = row.thickness.value_or(0);
    finding.thickness_kind = row.thickness_kind.value_or(ThicknessKind::unknown);
    finding.open = {row.a.open, row.b.open};
    finding.time = row.time.value_or(0);
    if (row.contacts) finding.contacts = *row.contacts;
    finding.more_contacts = row.more_contacts;
    return finding;
}

}  // namespace octopair::io
