#pragma once

#include <string>

#include "base/result.h"
#include "mapfile/map_file.h"

namespace vismap::mapfile {

class Header;
class Labels;

/// Conversion to protobuf and back. FromProto checks every field; the Error says which one is
/// wrong.
void ToProto(const SemanticMap& map, const MapMetadata& metadata, Header* proto);
void ToProto(const LabelTable& labels, Labels* proto);
/// The map without blocks and labels.
Result<LoadedMap> FromProto(const Header& proto);
Result<LabelTable> FromProto(const Labels& proto);

}  // namespace vismap::mapfile
