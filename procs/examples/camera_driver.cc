// A camera driver to start from: fill in the two functions of MyCamera with those of the SDK of
// your camera (RealSense, OAK, Kinect, ...) and of your pose source. As it stands, it computes the
// images of a box in front of a wall.
//
// Build it with the CMakeLists.txt beside it, then, while a vismap system runs:
//   ./camera_driver [tcpq://127.0.0.1:7700] [SECONDS]
#include <vismap/client.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <iostream>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>
#include <vismap/rgbd_frame_t.hpp>

namespace {

constexpr double kRateHz = 10;

volatile std::sig_atomic_t stop_requested = 0;

int64_t WallTimeUs() {
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  return std::chrono::duration_cast<std::chrono::microseconds>(now).count();
}

/// Images of one moment, as an SDK gives them.
struct Images {
  int64_t utime = 0;            ///< when they were taken [us], by the clock that the poses use
  std::vector<uint8_t> rgb;     ///< height x width x 3
  std::vector<uint16_t> depth;  ///< height x width [mm], registered to colour; 0 = not measured
};

/// Fill in this class.
class MyCamera {
 public:
  static constexpr int kWidth = 320, kHeight = 240;
  static constexpr double kFocal = 262.5, kCx = 159.5, kCy = 119.5;  // [px]

  /// Waits for the next images; nullopt when the camera has none.
  std::optional<Images> Next() {
    std::this_thread::sleep_until(next_);
    next_ += std::chrono::microseconds(static_cast<int64_t>(1e6 / kRateHz));
    Images images;
    images.utime = WallTimeUs();
    images.rgb.reserve(size_t{3} * kWidth * kHeight);
    images.depth.reserve(size_t{1} * kWidth * kHeight);
    for (int v = 0; v < kHeight; ++v) {
      for (int u = 0; u < kWidth; ++u) AddPixel(u, v, &images);
    }
    return images;
  }

  /// The pose of the camera in the world at this time: 4x4, row-major, p_W = T_W_C * p_C [m], with
  /// C: x right, y down, z forward. nullopt when the pose is not known.
  std::optional<std::vector<double>> PoseAt(int64_t /*utime*/) {
    // Looks along the world's x axis, 1 m above its floor.
    return std::vector<double>{0, 0, 1, 0, -1, 0, 0, 0, 0, -1, 0, 1, 0, 0, 0, 1};
  }

 private:
  // A box of 0.6 x 0.6 m, 1.5 m away, in front of a wall that is 2.5 m away.
  static void AddPixel(int u, int v, Images* images) {
    const double x = (u - kCx) / kFocal, y = (v - kCy) / kFocal;
    const bool box = std::abs(1.5 * x) < 0.3 && std::abs(1.5 * y) < 0.3;
    images->depth.push_back(box ? 1500 : 2500);
    const uint8_t shade = static_cast<uint8_t>((u / 16 + v / 16) % 2 == 0 ? 200 : 120);
    images->rgb.insert(images->rgb.end(), {shade, static_cast<uint8_t>(box ? 60 : shade), 90});
  }

  std::chrono::steady_clock::time_point next_ = std::chrono::steady_clock::now();
};

vismap::rgbd_frame_t MakeFrame(const Images& images, const std::vector<double>& T_W_C) {
  vismap::rgbd_frame_t frame{};
  frame.utime = images.utime;
  frame.camera_id = 0;
  frame.frame_number = -1;
  frame.after_utime = -1;
  std::copy(T_W_C.begin(), T_W_C.end(), frame.T_W_C);
  frame.color_camera.width = MyCamera::kWidth;
  frame.color_camera.height = MyCamera::kHeight;
  frame.color_camera.fx = frame.color_camera.fy = MyCamera::kFocal;
  frame.color_camera.cx = MyCamera::kCx;
  frame.color_camera.cy = MyCamera::kCy;
  frame.color_camera.distortion = vismap::camera_t::DISTORTION_NONE;
  frame.depth_camera = frame.color_camera;
  frame.depth_registered = 1;
  for (int i = 0; i < 4; ++i) frame.T_color_depth[5 * i] = 1;
  frame.depth_unit_m = 0.001;
  frame.depth_encoding = vismap::rgbd_frame_t::DEPTH_RAW_16;
  frame.depth.resize(images.depth.size() * 2);
  for (size_t i = 0; i < images.depth.size(); ++i) {  // little-endian
    frame.depth[2 * i] = static_cast<uint8_t>(images.depth[i] & 0xFF);
    frame.depth[2 * i + 1] = static_cast<uint8_t>(images.depth[i] >> 8);
  }
  frame.depth_size = static_cast<int32_t>(frame.depth.size());
  frame.color_encoding = vismap::rgbd_frame_t::COLOR_RAW_RGB;
  frame.color = images.rgb;
  frame.color_size = static_cast<int32_t>(frame.color.size());
  return frame;
}

/// Publishes one frame, or counts why there is none, so that vismap-doctor can tell.
void PublishNext(MyCamera* camera, vismap::Client* client) {
  const std::optional<Images> images = camera->Next();
  if (!images) {
    client->Count("frames.no_images");
    client->SetWaiting("waiting for images of the camera");
    return;
  }
  const auto pose = camera->PoseAt(images->utime);
  if (!pose) {
    client->Count("frames.no_pose");
    client->SetWaiting("waiting for the pose of the camera");
    return;
  }
  if (client->Publish("RGBD_FRAME", MakeFrame(*images, *pose))) {
    client->Count("frames.published");
    client->SetRunning();
  } else {
    client->Count("frames.unsent");
    client->SetWaiting("the frame could not be sent: there is no connection to the hub");
  }
}

}  // namespace

int main(int argc, char** argv) {
  std::signal(SIGINT, [](int) { stop_requested = 1; });
  std::signal(SIGTERM, [](int) { stop_requested = 1; });
  try {
    vismap::ClientOptions options;
    options.name = "camera-driver";
    if (argc > 1) options.url = argv[1];
    const double seconds = argc > 2 ? std::atof(argv[2]) : 1e9;
    vismap::Client client(options);
    MyCamera camera;
    const int64_t end = WallTimeUs() + static_cast<int64_t>(seconds * 1e6);
    while (stop_requested == 0 && WallTimeUs() < end) {
      PublishNext(&camera, &client);
      client.Handle(0);
    }
    std::cout << "unsent frames: " << client.counters("RGBD_FRAME").unsent << "\n";
    return client.counters("RGBD_FRAME").unsent == 0 ? 0 : 1;
  } catch (const std::exception& error) {
    std::cerr << "camera_driver: " << error.what() << "\n";
    return 1;
  }
}
