// Prints the hashes of the map of a few frames and of its mesh, and the SIMD level of the kernels
// in this executable. It is built several times, for one SIMD level each, see CMakeLists.txt.
#include <cinttypes>
#include <cstdio>
#include <exception>

#include "base/digest.h"
#include "exports/ply.h"
#include "objects/map_mesh.h"
#include "support/pipelines.h"

namespace {

using namespace vismap;

/// The SIMD level that the dynamic linker chooses among the clones of a kernel on this machine.
const char* BestLevel() {
#if defined(__x86_64__)
  if (__builtin_cpu_supports("x86-64-v4")) return "x86-64-v4";
  if (__builtin_cpu_supports("x86-64-v3")) return "x86-64-v3";
#endif
  return "baseline";
}

void PrintHash(const std::string& path, const DatasetOptions& options) {
  const auto inputs = testing_support::InputSequence(path, options).ReadAll();
  const SemanticMap map = testing_support::MapFast(inputs, {0.02, 4});
  std::printf("hash %s\n", HashMap(map).c_str());
  std::printf("hash %016" PRIx64 "\n", Checksum64(EncodePly(ExtractMesh(map), {})));
}

}  // namespace

int main() {
  try {
    std::printf("machine %s\n", BestLevel());
    PrintHash("synthetic:room?frames=40&width=321", {2, 6, CameraId{0}});
    if (const auto recorded = testing_support::RecordedSequence("7scenes"))
      PrintHash(*recorded, {5, 5, CameraId{0}});
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
