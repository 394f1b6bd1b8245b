#pragma once

#include <string>
#include <vector>

#include "base/result.h"
#include "config/process_options.h"
#include "exports/outputs.h"
#include "navigation/ground_grid.h"
#include "segmentation/segmentation_options.h"
#include "session/derived_options.h"

namespace vismap {

// What lives in this room: config files. The only user of options.pb.h (in .cc files). Which keys
// there are, and what they mean, stands in options.proto; defaults stand in the option structs.
// To add an option: a member in its struct with the default, the same name in fields.h and, with a
// comment, in options.proto, and a check of its range in validate.cc or in the room of the struct.

/// Everything that can be configured. The structs of the stages are inherited, so that a config can
/// be given to what takes one of them: SegmentFrame, MapSession, MakeProducts. Every member is a
/// section of the file with the same name, see fields.h; up_W stands in the section `objects`.
struct VismapConfig : SegmentationStageOptions, MapSessionOptions, OutputOptions {
  DepthSegmenterOptions depth_segmenter;
  MapServerOptions map_server;
  OctomapExporterOptions octomap_exporter;
  ViewerOptions viewer;
  SensorReplayOptions sensor_replay;
  DetectorOptions detector;
  HubOptions hub;
  BridgeOptions bridge;
  AdapterOptions adapter;
  GroundGridOptions ground_grid;
  SharedOptions pipeline;
};

/// Sets the options of a config that follow from others and are no keys. A config that was read has
/// them; one that a program changes needs this afterwards.
void DeriveOptions(VismapConfig* config);

/// Reads protobuf text. Unknown keys, wrong types, keys given twice and syntax errors fail with
/// `name`, line and column. Values are not judged: see Validate.
Result<VismapConfig> ParseConfig(const std::string& text, const std::string& name);

/// Everything that is wrong with the values, one sentence each; empty = nothing.
std::vector<std::string> Validate(const VismapConfig& config);

/// ParseConfig and Validate: fails with all problems in one sentence.
Result<VismapConfig> ParseValidConfig(const std::string& text, const std::string& name);

/// All values as text that ParseConfig reads back to the same config.
std::string PrintConfig(const VismapConfig& config);

}  // namespace vismap
