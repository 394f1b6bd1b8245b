#include "settings/settings.h"

namespace vismap {

namespace {

// Checks a config that the command line may have changed, and returns it in full.
Result<std::string> CheckConfig(const VismapConfig& config) {
  const std::vector<std::string> problems = Validate(config);
  if (!problems.empty()) return Fail("command line: " + problems.front());
  return PrintConfig(config);
}

}  // namespace

void UseConfig(VismapConfig* config, ProcessSpec* spec,
               const std::function<Result<void>()>& check) {
  spec->channel_prefix = &config->pipeline.channel_prefix;
  spec->read_config = [config](const std::string& text, const std::string& path) {
    return ReadConfig(text, path, config);
  };
  spec->check_config = [config, check]() -> Result<std::string> {
    if (const Result<void> checked = check(); !checked) return tl::unexpected(checked.error());
    DeriveOptions(config);
    return CheckConfig(*config);
  };
}

Result<void> ReadConfig(const std::string& text, const std::string& path, VismapConfig* config) {
  Result<VismapConfig> parsed = ParseValidConfig(text, path.empty() ? "defaults" : path);
  if (!parsed) return tl::unexpected(parsed.error());
  *config = std::move(*parsed);
  return {};
}

void ThreadOption::AddTo(CommandLine& line) {
  line.Option("--threads", &threads_, "Number of threads; 0 = all processors").AtLeast(0);
}

void CalibrationOptions::AddTo(CommandLine& line) {
  line.Option("--intrinsics", &intrinsics_,
              "fx,fy,cx,cy of the depth images in pixels, instead of what the sequence states");
  line.Option("--depth-unit", &depth_unit_m_,
              "Metres per step of the depth images; 0 = as the sequence states")
      .Range(0, 1);
  line.Choice(
      "--depth-registration", &registration_,
      {{"auto", DepthRegistration::kAuto},
       {"registered", DepthRegistration::kRegistered},
       {"kinect", DepthRegistration::kKinect}},
      "registered: depth was recorded as the colour camera sees it; kinect: as the infrared "
      "camera of a Kinect sees it; auto: as the sequence states");
}

Result<void> CalibrationOptions::SetIn(DatasetOptions* options) const {
  options->depth_unit_m = depth_unit_m_;
  options->registration = registration_;
  if (intrinsics_.empty()) return {};
  if (intrinsics_.size() != 4) {
    return Fail("--intrinsics: expected the four numbers fx,fy,cx,cy, found " +
                std::to_string(intrinsics_.size()));
  }
  options->intrinsics = {intrinsics_[0], intrinsics_[1], intrinsics_[2], intrinsics_[3]};
  return {};
}

std::unique_ptr<ThreadLimit> ThreadOption::Limit() const {
  return threads_ > 0 ? std::make_unique<ThreadLimit>(threads_) : nullptr;
}

}  // namespace vismap
