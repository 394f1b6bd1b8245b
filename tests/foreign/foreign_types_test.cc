// The types of other robots' programs are those that these programs have.

#include <gtest/gtest.h>

#include <vismap/foreign/bot_core/image_metadata_t.hpp>
#include <vismap/foreign/bot_core/image_t.hpp>
#include <vismap/foreign/bot_core/images_t.hpp>
#include <vismap/foreign/bot_core/planar_lidar_t.hpp>
#include <vismap/foreign/bot_core/pointcloud_t.hpp>
#include <vismap/foreign/bot_core/pose_t.hpp>
#include <vismap/foreign/bot_core/raw_t.hpp>
#include <vismap/foreign/bot_core/rigid_transform_t.hpp>
#include <vismap/foreign/drake/lcmt_header.hpp>
#include <vismap/foreign/drake/lcmt_image.hpp>
#include <vismap/foreign/drake/lcmt_image_array.hpp>
#include <vismap/foreign/drake/lcmt_point_cloud.hpp>
#include <vismap/foreign/drake/lcmt_point_cloud_field.hpp>
#include <vismap/foreign/drake/lcmt_viewer_draw.hpp>
#include <vismap/foreign/drake/lcmt_viewer_geometry_data.hpp>
#include <vismap/foreign/drake/lcmt_viewer_link_data.hpp>
#include <vismap/foreign/drake/lcmt_viewer_load_robot.hpp>
#include <vismap/foreign/geometry_msgs/Point.hpp>
#include <vismap/foreign/geometry_msgs/Pose.hpp>
#include <vismap/foreign/geometry_msgs/PoseStamped.hpp>
#include <vismap/foreign/geometry_msgs/PoseWithCovariance.hpp>
#include <vismap/foreign/geometry_msgs/Quaternion.hpp>
#include <vismap/foreign/geometry_msgs/Transform.hpp>
#include <vismap/foreign/geometry_msgs/TransformStamped.hpp>
#include <vismap/foreign/geometry_msgs/Twist.hpp>
#include <vismap/foreign/geometry_msgs/TwistWithCovariance.hpp>
#include <vismap/foreign/geometry_msgs/Vector3.hpp>
#include <vismap/foreign/nav_msgs/MapMetaData.hpp>
#include <vismap/foreign/nav_msgs/OccupancyGrid.hpp>
#include <vismap/foreign/nav_msgs/Odometry.hpp>
#include <vismap/foreign/openni2/image_metadata_t.hpp>
#include <vismap/foreign/openni2/image_t.hpp>
#include <vismap/foreign/openni2/images_t.hpp>
#include <vismap/foreign/robotlocomotion/viewer2_comms_t.hpp>
#include <vismap/foreign/sensor_msgs/CameraInfo.hpp>
#include <vismap/foreign/sensor_msgs/CompressedImage.hpp>
#include <vismap/foreign/sensor_msgs/Image.hpp>
#include <vismap/foreign/sensor_msgs/PointCloud2.hpp>
#include <vismap/foreign/sensor_msgs/PointField.hpp>
#include <vismap/foreign/sensor_msgs/RegionOfInterest.hpp>
#include <vismap/foreign/std_msgs/ColorRGBA.hpp>
#include <vismap/foreign/std_msgs/Duration.hpp>
#include <vismap/foreign/std_msgs/Header.hpp>
#include <vismap/foreign/std_msgs/Time.hpp>
#include <vismap/foreign/tf2_msgs/TFMessage.hpp>
#include <vismap/foreign/vision_msgs/BoundingBox3D.hpp>
#include <vismap/foreign/vision_msgs/Detection3D.hpp>
#include <vismap/foreign/vision_msgs/Detection3DArray.hpp>
#include <vismap/foreign/vision_msgs/ObjectHypothesis.hpp>
#include <vismap/foreign/vision_msgs/ObjectHypothesisWithPose.hpp>
#include <vismap/foreign/visualization_msgs/Marker.hpp>
#include <vismap/foreign/visualization_msgs/MarkerArray.hpp>

#include "wire/envelope.h"

namespace vismap {
namespace {

struct Fingerprint {
  std::string type;
  uint64_t found, expected;
};

template <typename Message>
Fingerprint FingerprintOf(uint64_t expected) {
  return {Message::getTypeName(), static_cast<uint64_t>(Message::getHash()), expected};
}

TEST(ForeignTypes, HaveTheFingerprintsOfTheOriginals) {
  const std::vector<Fingerprint> fingerprints = {
      FingerprintOf<foreign::geometry_msgs::Point>(0xae7e5fba5eeca11e),
      FingerprintOf<foreign::geometry_msgs::Pose>(0x245634ae2ab17b76),
      FingerprintOf<foreign::geometry_msgs::PoseStamped>(0x6a82696458c279a0),
      FingerprintOf<foreign::geometry_msgs::PoseWithCovariance>(0xce6428b127d11b5a),
      FingerprintOf<foreign::geometry_msgs::Quaternion>(0x363bdd3bf9180a2b),
      FingerprintOf<foreign::geometry_msgs::Transform>(0xee5ff42647bf3f91),
      FingerprintOf<foreign::geometry_msgs::TransformStamped>(0x299ff424b83a3514),
      FingerprintOf<foreign::geometry_msgs::Twist>(0x2e7c07d7cdf7e027),
      FingerprintOf<foreign::geometry_msgs::TwistWithCovariance>(0xb439635a59217509),
      FingerprintOf<foreign::geometry_msgs::Vector3>(0xae7e5fba5eeca11e),
      FingerprintOf<foreign::nav_msgs::MapMetaData>(0x25ace38661e74534),
      FingerprintOf<foreign::nav_msgs::OccupancyGrid>(0xe7dfd179cdfc3b65),
      FingerprintOf<foreign::nav_msgs::Odometry>(0x94e17f94648cf0e4),
      FingerprintOf<foreign::sensor_msgs::CameraInfo>(0xafb501b00707a02a),
      FingerprintOf<foreign::sensor_msgs::CompressedImage>(0xb8d011c10412b9a1),
      FingerprintOf<foreign::sensor_msgs::Image>(0x535cface1f4f5717),
      FingerprintOf<foreign::sensor_msgs::PointCloud2>(0xf5eb3da1c2853175),
      FingerprintOf<foreign::sensor_msgs::PointField>(0xe05c1c07e0850bae),
      FingerprintOf<foreign::sensor_msgs::RegionOfInterest>(0x73150d3a0b307e1c),
      FingerprintOf<foreign::std_msgs::ColorRGBA>(0x6e32801f8dc60234),
      FingerprintOf<foreign::std_msgs::Duration>(0xbc3a494751d96c91),
      FingerprintOf<foreign::std_msgs::Header>(0x2fdb11453be64af7),
      FingerprintOf<foreign::std_msgs::Time>(0xbc3a494751d96c91),
      FingerprintOf<foreign::tf2_msgs::TFMessage>(0xc2b8a1c33a8923ec),
      FingerprintOf<foreign::vision_msgs::BoundingBox3D>(0x67c9065caa8d65ef),
      FingerprintOf<foreign::vision_msgs::Detection3D>(0xbf718df7ba916cb6),
      FingerprintOf<foreign::vision_msgs::Detection3DArray>(0xea027f6760f2ebd2),
      FingerprintOf<foreign::vision_msgs::ObjectHypothesis>(0x719359aa86271644),
      FingerprintOf<foreign::vision_msgs::ObjectHypothesisWithPose>(0x4bb2ad4de62d7853),
      FingerprintOf<foreign::visualization_msgs::Marker>(0x7496e78e9bb40aeb),
      FingerprintOf<foreign::visualization_msgs::MarkerArray>(0x9cf4d95891a43112),
      FingerprintOf<foreign::drake::lcmt_header>(0x124e586663318e54),
      FingerprintOf<foreign::drake::lcmt_image>(0xbd7080d565ec47d1),
      FingerprintOf<foreign::drake::lcmt_image_array>(0x1572a7d08d9022e6),
      FingerprintOf<foreign::drake::lcmt_point_cloud>(0x17f2c128b5d25a95),
      FingerprintOf<foreign::drake::lcmt_point_cloud_field>(0xd2628d58fb331b3f),
      FingerprintOf<foreign::drake::lcmt_viewer_draw>(0x414f0bfe5b2f4244),
      FingerprintOf<foreign::drake::lcmt_viewer_geometry_data>(0x5d2e34cb3257db07),
      FingerprintOf<foreign::drake::lcmt_viewer_link_data>(0x51252725af982a63),
      FingerprintOf<foreign::drake::lcmt_viewer_load_robot>(0x8987209b10aa2d39),
      FingerprintOf<foreign::bot_core::image_metadata_t>(0x9a4b634d0577fb8e),
      FingerprintOf<foreign::bot_core::image_t>(0x14739ffe13d5f5f0),
      FingerprintOf<foreign::bot_core::images_t>(0x20ba4f05e8f5e33a),
      FingerprintOf<foreign::bot_core::planar_lidar_t>(0xe3d17423180b5e8d),
      FingerprintOf<foreign::bot_core::pointcloud_t>(0x0d89dc76eb295069),
      FingerprintOf<foreign::bot_core::pose_t>(0x2e16efb052b0105e),
      FingerprintOf<foreign::bot_core::raw_t>(0x30571b45b804c18e),
      FingerprintOf<foreign::bot_core::rigid_transform_t>(0xea9ffbf2acc5c5ae),
      FingerprintOf<foreign::openni2::image_metadata_t>(0x9a4b634d0577fb8e),
      FingerprintOf<foreign::openni2::image_t>(0x14739ffe13d5f5f0),
      FingerprintOf<foreign::openni2::images_t>(0x20ba4f05e8f5e33a),
      FingerprintOf<foreign::robotlocomotion::viewer2_comms_t>(0xd368e03f33c568be),
  };
  EXPECT_EQ(fingerprints.size(), 52u);
  for (const Fingerprint& type : fingerprints) EXPECT_EQ(type.found, type.expected) << type.type;
}

TEST(ForeignTypes, RejectLengthsThatAreImpossible) {
  foreign::drake::lcmt_viewer_draw draw{};
  draw.num_links = 1;
  draw.link_name = {"link"};
  draw.robot_num = {0};
  draw.position = {{1, 2, 3}};
  draw.quaternion = {{1, 0, 0, 0}};
  std::vector<uint8_t> bytes = Pack(draw);
  ASSERT_TRUE(Unpack<foreign::drake::lcmt_viewer_draw>(bytes, bytes.size()));
  for (const uint8_t high :
       std::vector<uint8_t>{0x7f, 0xff, 0x01}) {  // the first byte of num_links
    bytes[16] = high;
    EXPECT_FALSE(Unpack<foreign::drake::lcmt_viewer_draw>(bytes, bytes.size()));
  }
  foreign::sensor_msgs::Image image{};
  bytes = Pack(image);
  bytes[8] = 0x7f;  // data_length
  EXPECT_FALSE(Unpack<foreign::sensor_msgs::Image>(bytes, bytes.size()));
}

}  // namespace
}  // namespace vismap
