#pragma once

#include <string>

#include "base/result.h"
#include "mapfile/map_file.h"

namespace vismap::mapfile {

class Header;
class Labels;

/// Values to protobuf and back. The way back checks every field and says what is wrong.
void ToProto(const SemanticMap& map, const MapMetadata& metadata, Header* proto);
void ToProto(const LabelTable& labels, Labels* proto);
Result<LoadedMap> FromProto(const Header& proto);  ///< a map without blocks and labels
Result<LabelTable> FromProto(const Labels& proto);

}  // namespace vismap::mapfile
