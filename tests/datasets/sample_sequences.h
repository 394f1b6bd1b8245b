#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "datasets/dataset.h"
#include "support/temp_folder.h"

namespace vismap {

// Small sequences of every format, in folders that the tests write and break.

inline constexpr int kWidth = 16, kHeight = 12;  // of their depth images
inline constexpr char kRigid[] = "0 -1 0 1.5\n1 0 0 2.5\n0 0 1 3.5\n0 0 0 1\n";
inline constexpr char kLost[] =
    "-inf -inf -inf -inf\n-inf -inf -inf -inf\n-inf -inf -inf -inf\n-inf -inf -inf -inf\n";

/// The pose kRigid.
Eigen::Matrix4d RigidMatrix();
/// A number with zeros before it.
std::string Digits(int number, size_t count);

// Each writes three frames into the folder "seq", with everything that its format has.
void WriteSceneNn(const TempFolder& folder);
void WriteSevenScenes(const TempFolder& folder);
void WriteIcl(const TempFolder& folder);
void WriteScanNet(const TempFolder& folder);
void WriteReplica(const TempFolder& folder);
void WriteRedwood(const TempFolder& folder);
/// The same in the folder `name`.
void WriteTum(const TempFolder& folder, const std::string& name = "seq_fr1_x");
/// The same in the folder "seq_fr1".
void WritePlainTum(const TempFolder& folder);
/// One frame as in the original 7-Scenes: a Kinect's depth, whose pixels without a return are
/// `hole`, and no intrinsics.
void WriteKinect(const TempFolder& folder, int hole);

/// A small sequence of one format, and the images of its second and of its last frame.
struct SampleSequence {
  const char* name;
  void (*write)(const TempFolder&);
  std::string folder, color2, depth2, color3, depth3;
};
std::vector<SampleSequence> AllFormats();

/// Opens a sequence; the test fails and gets nullptr when it cannot be opened.
std::unique_ptr<Dataset> OpenOrFail(const std::filesystem::path& path,
                                    const DatasetOptions& options = {});
SensorFrame ReadOrFail(const Dataset& dataset, size_t i);
/// The error of opening the sequence, or why one of its frames or its colour cannot be used; "" =
/// none.
std::string ErrorOf(const std::filesystem::path& path);
/// How many frames of a sequence can be read, and how many of them with colour.
std::pair<int, int> CountFrames(const std::filesystem::path& path);

}  // namespace vismap
