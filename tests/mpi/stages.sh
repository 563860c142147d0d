#!/usr/bin/env bash
# Tests that `octopair detect --engine mpi` with filters writes the files of the local engine, and ends in the same way
# on all ranks.
#
#     stages.sh PROGRAM MPIRUN
source "$(dirname "$(realpath "$0")")/in_folder.sh"

python3 - << 'END'
# Shapes of every kind, close to each other, and a mesh that intersects itself.
import array, json, math, random, struct
random.seed(7)
shapes = {
    "sphere": {"type": "sphere", "radius": 0.5},
    "box": {"type": "box", "half_extents": [0.5, 0.3, 0.2]},
    "capsule": {"type": "capsule", "radius": 0.2, "length": 0.8},
    "cylinder": {"type": "cylinder", "radius": 0.3, "length": 0.7},
    "cone": {"type": "cone", "radius": 0.4, "length": 0.8},
    "ellipsoid": {"type": "ellipsoid", "radii": [0.3, 0.4, 0.5]},
    "hull": {"type": "convex_hull", "points": [[0, 0, 0], [0.6, 0, 0], [0, 0.6, 0], [0, 0, 0.6]]},
    "mesh": {"type": "mesh", "vertices": [[0, 0, 0], [0.7, 0, 0], [0, 0.7, 0], [0, 0, 0.7]],
             "triangles": [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]]},
    "plane": {"type": "plane", "normal": [0.1, 0, 1], "offset": 0.4},
}
def place(size):
    return [random.uniform(0, size) for _ in range(3)]
def scene(objects, size, **more):
    kinds = [kind for kind in shapes if kind != "plane"]
    made = [{"name": f"part {i % 50}", "shape": kinds[i % len(kinds)], "position": place(size),
             "rotation": [random.uniform(-1, 1) for _ in range(4)], "parent": f"group {i % 9}", **more}
            for i in range(objects)]
    for i, one in enumerate(made):
        if i % 5 == 0: one["padding"] = 0.05
        if i % 7 == 0: one["mask"] = 2
    return {"shapes": shapes, "objects": made}
def dump(name, what):
    with open(name, "w") as f: json.dump(what, f)
first = scene(300, 5)
first["objects"].append({"name": "floor", "shape": "plane"})
dump("shapes.json", first)
dump("others.json", scene(120, 5))
moving = scene(100, 5)
for one in moving["objects"]: one["end_position"] = place(5)
dump("moving.json", moving)
dump("rules.json", {"ignored_pairs": [["part 1", "part 2"]], "exclude": [{"a": "part 1*", "b": "part 3?"}]})
side = 24
with open("folds.off", "w") as f:
    f.write(f"OFF\n{side * side} {2 * (side - 1) ** 2} 0\n")
    for i in range(side):
        for k in range(side):
            f.write(f"{i + 2 * math.sin(k * 1.3)} {k + 2 * math.cos(i * 0.9)} {math.sin(i * 0.7 + k)}\n")
    for i in range(side - 1):
        for k in range(side - 1):
            at = i * side + k
            f.write(f"3 {at} {at + 1} {at + side}\n3 {at + 1} {at + side + 1} {at + side}\n")
lines = []
def ifc(instance):
    lines.append(f"#{len(lines) + 1}={instance};")
    return f"#{len(lines)}"
def guid(): return f"'{len(lines):022}'"
for instance in ("PERSON($,'n',$,$,$,$,$,$)", "ORGANIZATION($,'o',$,$,$)", "PERSONANDORGANIZATION(#1,#2,$)",
                 "APPLICATION(#2,'1','a','a')", "OWNERHISTORY(#3,#4,$,.ADDED.,$,$,$,0)",
                 "SIUNIT(*,.LENGTHUNIT.,$,.METRE.)", "UNITASSIGNMENT((#6))", "CARTESIANPOINT((0.,0.,0.))",
                 "AXIS2PLACEMENT3D(#8,$,$)", "GEOMETRICREPRESENTATIONCONTEXT($,'Model',3,1.E-5,#9,$)",
                 "PROJECT('0000000000000000000001',#5,'P',$,$,$,$,(#10),#7)", "LOCALPLACEMENT($,#9)",
                 "BUILDING('0000000000000000000002',#5,'B',$,$,#12,$,$,.ELEMENT.,$,$,$)",
                 "RELAGGREGATES('0000000000000000000003',#5,$,$,#11,(#13))", "DIRECTION((0.,0.,1.))"):
    ifc("IFC" + instance)
def element(kind, x, width, more=""):  # a box of 1 in y and z
    place = ifc(f"IFCAXIS2PLACEMENT2D({ifc(f'IFCCARTESIANPOINT(({x},0.))')},$)")
    solid = ifc(f"IFCEXTRUDEDAREASOLID({ifc(f'IFCRECTANGLEPROFILEDEF(.AREA.,$,{place},{width},1.)')},#9,#15,1.)")
    body = ifc(f"IFCSHAPEREPRESENTATION(#10,'Body','SweptSolid',({solid}))")
    shape = ifc(f"IFCPRODUCTDEFINITIONSHAPE($,$,({body}))")
    return ifc(f"{kind}({guid()},#5,'e',$,$,#12,{shape},${more})")
wall = element("IFCWALL", 0., 20.)
doors = [element("IFCDOOR", float(i), 1.5, ",$,$") for i in range(8)]
for door in doors[:-1]:
    opening = ifc(f"IFCOPENINGELEMENT({guid()},#5,$,$,$,#12,$,$)")
    ifc(f"IFCRELVOIDSELEMENT({guid()},#5,$,$,{wall},{opening})")
    ifc(f"IFCRELFILLSELEMENT({guid()},#5,$,$,{opening},{door})")
ifc(f"IFCRELCONTAINEDINSPATIALSTRUCTURE({guid()},#5,$,$,({','.join([wall, *doors])}),#13)")
with open("model.ifc", "w") as f:
    f.write("ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION((''),'2;1');\nFILE_NAME('','',(''),(''),'','','');\n"
            "FILE_SCHEMA(('IFC2X3'));\nENDSEC;\nDATA;\n" + "\n".join(lines) + "\nENDSEC;\nEND-ISO-10303-21;\n")
text = "{'descr': '<f8', 'fortran_order': False, 'shape': (301,), }"
text += " " * (63 - (10 + len(text)) % 64) + "\n"
with open("padding.npy", "wb") as f:
    f.write(b"\x93NUMPY\x01\x00" + struct.pack("<H", len(text)) + text.encode())
    f.write(array.array("d", [0.01 * (i % 7) for i in range(301)]).tobytes())
END

# RANKS NAME ARGUMENTS...: fails unless ranks write the same file as threads, and the file has results.
same_results() {
    same "$@"
    [ "$(wc -l < "local.$2")" -gt 2 ] || [ "${2##*.}" = npy ] || fail "nothing to compare for: $*"
}
for ranks in 1 2; do same_results $ranks found.jsonl shapes.json --stage features --margin 0.02; done
same_results 3 found.csv shapes.json --stage objects --order octal --padding padding.npy
same_results 2 found.npy shapes.json others.json --stage objects
same_results 3 found.jsonl shapes.json --against others.json --stage features --max-contacts 2 --exclude rules.json
same_results 3 found.jsonl shapes.json --stage features --margin 0.02 --classes clearance,touching,contained --min-depth 0.01 --tolerance 0.05
same_results 2 found.csv moving.json --stage objects --same-parent exclude
same_results 3 pairs.csv shapes.json --stage pairs
same_results 2 pairs.npy shapes.json --stage pairs --exclude rules.json
same_results 3 found.jsonl folds.off --objects triangle --stage features --adjacent include
if "$program" info | grep -q 'mesh scenes'; then
    same_results 2 found.jsonl model.ifc --exclude fills
    [ "$(wc -l < local.found.jsonl)" = 8 ] || fail "a pair of a door and its wall is in the result, or another is not"
fi
[ "$("$program" detect others.json --quiet)" = "$(on_ranks 2 detect others.json --engine mpi --quiet)" ] ||
    fail "ranks print other pairs"

# The limit counts the collisions that pass the filters on all ranks. The result ends within the collisions of the first
# rank, within those of a later rank, or is complete.
all=$("$program" detect shapes.json --stage features --count-only --quiet)
[ "$all" = "$(on_ranks 3 detect shapes.json --stage features --engine mpi --count-only --quiet)" ] || fail "another count"
for limit in 1 $((all / 2)) "$all"; do
    "$program" detect shapes.json --stage features --limit "$limit" --output local.jsonl --stats local.json --quiet
    on_ranks 3 detect shapes.json --stage features --limit "$limit" --output ranks.jsonl --stats ranks.json --quiet \
        --engine mpi
    cmp local.jsonl ranks.jsonl || fail "another result within the limit of $limit"
    for key in pairs truncated; do
        [ "$(grep "^  \"$key\"" local.json)" = "$(grep "^  \"$key\"" ranks.json)" ] || fail "$key, limit $limit"
    done
done
python3 - << 'END'
# Statistics of the last call, which the limit did not cut: the counters of filters are sums over all ranks.
import json
local, ranks = (json.load(open(name)) for name in ("local.json", "ranks.json"))
counts = lambda stats: [(f["name"], f["in"], f["out"]) for f in stats["filters"]]
assert ranks["ranks"] == 3 and len(counts(ranks)) > 1 and local["candidates"] > local["pairs"] > 100
assert counts(local) == counts(ranks) and local["candidates"] == ranks["candidates"]
END

# Comparison with an older result, and a report page.
head -n 100 local.jsonl > old.jsonl
against_old() { echo "shapes.json --baseline old.jsonl --output $1.jsonl --report $1.html --stats $1.json --quiet"; }
"$program" detect $(against_old local)
on_ranks 2 detect $(against_old ranks) --engine mpi
cmp local.jsonl ranks.jsonl && cmp local.html ranks.html || fail "ranks give another result with a baseline"
[ "$(grep '"same"' local.json)" = "$(grep '"same"' ranks.json)" ] || fail "another number of same collisions"

# Statuses and BCF. What options leave out on any rank keeps its status, and approved collisions do not count on any rank.
"$program" detect shapes.json --statuses local_decided.json --output local.bcf --quiet
on_ranks 3 detect shapes.json --statuses ranks_decided.json --output ranks.bcf --quiet --engine mpi
cmp local_decided.json ranks_decided.json && cmp local.bcf ranks.bcf || fail "ranks give other statuses or topics"
sed -i 's/"status": "new"/"status": "approved"/' local_decided.json ranks_decided.json
on_ranks 3 detect shapes.json --statuses ranks_decided.json --output ranks.csv --fail-on-collision --quiet --engine mpi ||
    fail "approved collisions count on ranks"
on_ranks 2 detect shapes.json --stage features --statuses ranks_decided.json --output ranks.csv --quiet --engine mpi \
    --classes touching --exclude rules.json
[ "$(grep -c '"status": "approved"' local_decided.json)" = "$(grep -c '"status": "approved"' ranks_decided.json)" ] ||
    fail "ranks resolve what options leave out"

echo '{"objects": [{"shape": {"type": "sphere", "radius": 1}}, {"shape": {"type": "sphere", "radius": -1}}]}' > bad.json
echo '{"ignored_pairs": [["part 1", "nobody"]]}' > nobody.json
refuses 3 'bad.json: .*radius' bad.json
refuses 3 "nobody.json: .*'nobody'" shapes.json --exclude nobody.json
on_ranks 2 detect shapes.json --engine mpi --report /nowhere/page.html --output no.csv --quiet 2> errors.txt &&
    fail "detect succeeded without its report"
[ ! -e no.csv ] || fail "detect wrote a result without its report"
echo "ranks filter as threads do"
