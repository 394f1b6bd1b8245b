#include "exports/ply.h"

#include <gtest/gtest.h>

#include <cstring>

#include "support/mesh_checks.h"
#include "support/temp_folder.h"

namespace vismap {
namespace {

using testing_support::SameMesh;

Mesh SmallMesh() {
  Mesh mesh;
  for (uint32_t i = 0; i < 5; ++i) {
    MeshVertex vertex;
    vertex.position_W = Eigen::Vector3f(0.1F, -2.5F, 3e-7F) * static_cast<float>(i + 1);
    vertex.normal_W = Eigen::Vector3f(0, 0.6F, -0.8F);
    vertex.color = {static_cast<uint8_t>(i), 128, 255};
    vertex.segment = SegmentLabel{4'000'000'000u + i};
    vertex.instance = InstanceId{70'000u + i};
    vertex.class_id = ClassId{static_cast<uint16_t>(65'535 - i)};
    mesh.vertices.push_back(vertex);
  }
  mesh.triangles = {{0, 1, 2}, {2, 1, 3}, {4, 0, 3}};
  return mesh;
}

const PlyInfo kInfo{"kitchen of 3", {{ClassId{62}, "chair"}, {ClassId{70}, "toilet seat"}}};

std::vector<uint8_t> Bytes(const std::string& text) { return {text.begin(), text.end()}; }

template <typename T>
void Append(T value, std::vector<uint8_t>* bytes) {
  const auto* data = reinterpret_cast<const uint8_t*>(&value);
  bytes->insert(bytes->end(), data, data + sizeof(T));
}

TEST(Ply, RoundTripKeepsEverything) {
  const auto file = DecodePly(EncodePly(SmallMesh(), kInfo), "a.ply");
  ASSERT_TRUE(file) << file.error().message;
  EXPECT_TRUE(SameMesh(file->mesh, SmallMesh()));
  EXPECT_EQ(file->info, kInfo);
}

TEST(Ply, EmptyMeshRoundTrips) {
  const auto file = DecodePly(EncodePly({}, {}), "a.ply");
  ASSERT_TRUE(file) << file.error().message;
  EXPECT_TRUE(file->mesh.vertices.empty());
}

TEST(Ply, HeaderIsWhatScriptsRelyOn) {
  const auto bytes = EncodePly(SmallMesh(), {});
  const std::string header =
      "ply\nformat binary_little_endian 1.0\nelement vertex 5\nproperty float x\nproperty float "
      "y\nproperty float z\nproperty float nx\nproperty float ny\nproperty float nz\nproperty "
      "uchar red\nproperty uchar green\nproperty uchar blue\nproperty uint segment\nproperty uint "
      "instance\nproperty ushort class\nelement face 3\nproperty list uchar int "
      "vertex_indices\nend_header\n";
  EXPECT_EQ(std::string(bytes.begin(), bytes.begin() + static_cast<long>(header.size())), header);
  EXPECT_EQ(bytes.size(), header.size() + 5 * 37 + 3 * 13);
}

TEST(Ply, LineBreaksCannotBreakTheHeader) {
  const auto file = DecodePly(EncodePly(SmallMesh(), {"a\nend_header\n", {}}), "a.ply");
  ASSERT_TRUE(file) << file.error().message;
  EXPECT_EQ(file->mesh.vertices.size(), 5u);
}

TEST(Ply, ReadsOtherOrdersTypesPolygonsAndElements) {
  auto bytes = Bytes(
      "ply\r\nformat binary_little_endian 1.0\r\nobj_info from elsewhere\r\nelement camera 1\r\n"
      "property list uchar short name\r\nproperty float fov\r\nelement vertex 4\r\nproperty ushort "
      "label\r\nproperty double z\r\nproperty double y\r\nproperty double x\r\nproperty uchar "
      "alpha\r\nelement face 1\r\nproperty uchar flags\r\nproperty list ushort uint "
      "vertex_index\r\nend_header\r\n");
  Append<uint8_t>(2, &bytes);
  Append<int16_t>(7, &bytes);
  Append<int16_t>(8, &bytes);
  Append<float>(90, &bytes);
  for (uint16_t i = 0; i < 4; ++i) {
    Append<uint16_t>(static_cast<uint16_t>(10 + i), &bytes);
    for (const double c : {3.0, 2.0, 1.0}) Append<double>(c + i, &bytes);
    Append<uint8_t>(255, &bytes);
  }
  Append<uint8_t>(0, &bytes);
  Append<uint16_t>(4, &bytes);
  for (uint32_t i = 0; i < 4; ++i) Append<uint32_t>(i, &bytes);

  const auto file = DecodePly(bytes, "a.ply");
  ASSERT_TRUE(file) << file.error().message;
  ASSERT_EQ(file->mesh.vertices.size(), 4u);
  EXPECT_EQ(file->mesh.vertices[2].position_W, Eigen::Vector3f(3, 4, 5));
  EXPECT_EQ(file->mesh.vertices[3].segment, SegmentLabel{13});
  const std::vector<std::array<uint32_t, 3>> fan{{0, 1, 2}, {0, 2, 3}};
  EXPECT_EQ(file->mesh.triangles, fan);
}

TEST(Ply, SaysWhatIsWrong) {
  const auto message = [](const std::vector<uint8_t>& bytes) {
    const auto file = DecodePly(bytes, "a.ply");
    return file ? std::string("no error") : file.error().message;
  };
  EXPECT_EQ(message(Bytes("PK\n")), "a.ply: expected a PLY file, but the first line is not 'ply'");
  EXPECT_EQ(message(Bytes("ply\n")), "a.ply: the file ends inside its header");
  EXPECT_NE(message(Bytes("ply\nformat ascii 1.0\n")).find("line 2"), std::string::npos);
  EXPECT_NE(message(Bytes("ply\nelement vertex 1\nproperty float x\nend_header\nabcd"))
                .find("x, y and z"),
            std::string::npos);
  EXPECT_NE(message(Bytes("ply\nelement vertex 99999999999999\nproperty float x\nend_header\n"))
                .find("found only 0 bytes"),
            std::string::npos);
  Mesh mesh = SmallMesh();
  mesh.triangles[1][2] = 5;
  EXPECT_EQ(message(EncodePly(mesh, {})),
            "a.ply: face 1: expected vertex indices below 5, found one out of range");
}

TEST(Ply, TwoElementsOfOneNameAreAnError) {
  // Else the face would refer to vertices that are no longer there.
  std::vector<uint8_t> bytes = Bytes(
      "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty char x\nproperty char y\n"
      "property char z\nelement face 1\nproperty list uchar uchar vertex_indices\n"
      "element vertex 0\nproperty char x\nproperty char y\nproperty char z\nend_header\n");
  bytes.resize(bytes.size() + 9);
  for (const int byte : {3, 0, 1, 2}) bytes.push_back(static_cast<uint8_t>(byte));
  const auto file = DecodePly(bytes, "a.ply");
  ASSERT_FALSE(file);
  EXPECT_NE(file.error().message.find("found 'element vertex 0'"), std::string::npos);
}

TEST(Ply, LargeMeshesAreRefused) {
  const auto bytes = EncodePly(SmallMesh(), {});
  EXPECT_TRUE(DecodePly(bytes, "a.ply", {.vertices = 5, .triangles = 3}));
  EXPECT_EQ(DecodePly(bytes, "a.ply", {.vertices = 4}).error().message,
            "a.ply: expected at most 4 vertices, found 5");
  EXPECT_EQ(DecodePly(bytes, "a.ply", {.triangles = 2}).error().message,
            "a.ply: expected at most 2 triangles, found more");
  std::string header = "ply\n";
  for (int i = 0; i < 100'000; ++i) header += "comment\n";
  EXPECT_NE(DecodePly(Bytes(header), "a.ply").error().message.find("at most 100000 lines"),
            std::string::npos);
}

TEST(Ply, LargeFilesAreRefusedBeforeTheyAreRead) {
  const TempFolder folder;
  folder.Write("large.ply", "ply\n");
  std::filesystem::resize_file(folder / "large.ply", uintmax_t{1} << 40);  // a sparse file
  const std::string error = ReadPly(folder / "large.ply").error().message;
  EXPECT_NE(error.find("large.ply: expected at most 2147483648 bytes"), std::string::npos) << error;
}

TEST(Ply, EveryTruncationIsAnError) {
  const auto bytes = EncodePly(SmallMesh(), kInfo);
  for (size_t size = 0; size < bytes.size(); ++size) {
    EXPECT_FALSE(DecodePly(std::span(bytes).first(size), "a.ply")) << size;
  }
}

TEST(Ply, FlippedBitsGiveAMeshOrAnErrorNeverACrash) {
  const auto original = EncodePly(SmallMesh(), kInfo);
  uint64_t state = 1;
  for (int round = 0; round < 20000; ++round) {
    auto bytes = original;
    for (int flips = 0; flips < 1 + round % 3; ++flips) {
      state = state * 6364136223846793005ull + 1442695040888963407ull;
      bytes[(state >> 33) % bytes.size()] ^= static_cast<uint8_t>(1u << ((state >> 20) & 7));
    }
    const auto file = DecodePly(bytes, "a.ply");
    if (!file) continue;
    for (const auto& triangle : file->mesh.triangles) {
      for (const uint32_t index : triangle) ASSERT_LT(index, file->mesh.vertices.size());
    }
  }
}

TEST(Ply, FilesNameTheirPathInErrors) {
  EXPECT_NE(ReadPly("/nonexistent/m.ply").error().message.find("/nonexistent/m.ply"),
            std::string::npos);
  EXPECT_FALSE(WritePly("/nonexistent/m.ply", {}, {}));
}

}  // namespace
}  // namespace vismap
