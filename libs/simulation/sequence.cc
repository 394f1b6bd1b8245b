#include "simulation/sequence.h"

#include "simulation/synthetic_dataset.h"

namespace vismap {

Result<std::unique_ptr<Dataset>> OpenSequence(const std::string& path, const std::string& format,
                                              const DatasetOptions& options) {
  if (!IsSyntheticPath(path)) {
    if (format == "synthetic") {
      return Fail(
          path +
          ": expected synthetic:room or synthetic:office for the format \"synthetic\", found "
          "another path");
    }
    return OpenDataset(path, format, options);
  }
  if (!format.empty() && format != "synthetic") {
    return Fail(path + " is a computed sequence, not of format \"" + format + "\"");
  }
  if (const auto checked = CheckOptions(options); !checked) return Fail(checked.error().message);
  if (options.intrinsics || options.depth_unit_m > 0 ||
      options.registration == DepthRegistration::kKinect) {
    return Fail(path +
                " is a computed sequence; its intrinsics, depth unit and registration are known "
                "and cannot be given");
  }
  const Result<SyntheticOptions> synthetic = ParseSyntheticPath(path);
  if (!synthetic) return Fail(synthetic.error().message);
  return MakeSyntheticDataset(*synthetic, options);
}

Result<std::unique_ptr<DetectionSource>> OpenDetections(const std::string& path) {
  if (!IsSyntheticPath(path)) return LoadDetections(path);
  const Result<SyntheticOptions> synthetic = ParseSyntheticPath(path);
  if (!synthetic) return Fail(synthetic.error().message);
  return MakeSyntheticDetections(*synthetic);
}

}  // namespace vismap
