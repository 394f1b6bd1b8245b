#pragma once

#include <vector>

#include "map/label_table.h"
#include "meshing/mesh.h"
#include "objects/label_surfaces.h"

namespace vismap {

/// Joins the parts of things that no detector named: depth divides a shelf into boards and a stool
/// into seat and legs, and each of these parts has a label. Returns for every label the lowest
/// label of the thing that it is part of: itself for all labels that are joined to no other one.
///
/// Two parts are joined if the border between them is long enough (min_part_contact), neither rests
/// on the other one, masks have not shown them as two things, and the whole is no larger than
/// max_whole_size_m. Structure, instances, and larger surfaces are no parts. A whole of which too
/// much borders on other such surface (max_whole_leak) is left in parts: it is not separate from
/// what is around it. The result follows from the map alone, so later frames can change it.
///
/// `mesh` must have its instances read out, `surfaces` are those of its labels. options.up_W is the
/// upward direction. See libs/METHOD.md, Objects.
std::vector<SegmentLabel> JoinParts(const LabelTable& table, const Mesh& mesh,
                                    const LabelSurfaces& surfaces, const ObjectOptions& options);

}  // namespace vismap
