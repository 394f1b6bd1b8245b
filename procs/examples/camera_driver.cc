// A driver of an RGB-D camera to start from: replace the class MyCamera, and keep the rest. As it
// stands, it computes the images of a box in front of a wall, so that it can be tried at once.
//
// Build it with the CMakeLists.txt beside it, then, while a vismap system runs:
//   ./camera_driver [--lcm-url URL] [--channel-prefix PREFIX] [--name NAME] [--camera-id N]
//                   [--rate HZ] [--frames N]
// It ends after so many frames, by SIGINT or SIGTERM, or when the camera has gone. Exit codes: 0 it
// was told to end, 1 it failed, 2 wrong usage.
#include <vismap/client.h>
#include <vismap/clocks.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <exception>
#include <iostream>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>
#include <vismap/rgbd_frame_t.hpp>

namespace {

using Seconds = std::chrono::duration<double>;
using SteadyClock = std::chrono::steady_clock;

volatile std::sig_atomic_t stop_requested = 0;

/// What a camera gives at one time.
struct Images {
  double device_s = 0;          ///< time stamp of the camera, by its own clock [s]
  std::vector<uint8_t> rgb;     ///< height x width x 3
  std::vector<uint16_t> depth;  ///< height x width, in steps of kDepthUnitM; 0 = not measured
};

/// 4x4, row-major: p_W = T_W_C * p_C [m], with C: x right, y down, z forward.
using Pose = std::vector<double>;

/// The camera and its pose. Replace the bodies by calls of your SDK, for example
/// - RealSense: pipeline.try_wait_for_frames(); frame.get_timestamp() / 1000; get_depth_scale();
///   depth may stay unregistered: fill in depth_camera and T_color_depth of the message
///   (get_extrinsics_to(), whose rotation is stored by columns)
/// - OAK (depthai): queue->tryGet(); getTimestamp(); depth in millimetres; readCalibration()
/// - Azure Kinect: k4a_device_get_capture(); device_timestamp_usec / 1e6;
///   k4a_transformation_depth_image_to_color_camera()
class MyCamera {
 public:
  static constexpr double kDepthUnitM = 0.001;

  static vismap::camera_t Intrinsics() {
    vismap::camera_t camera{};
    camera.width = kWidth;
    camera.height = kHeight;
    camera.fx = camera.fy = kFocal;
    camera.cx = kCx;
    camera.cy = kCy;
    camera.distortion = vismap::camera_t::DISTORTION_NONE;
    return camera;
  }

  /// Waits for the next images, at most a second; nullopt when none came. Throws when the camera
  /// has gone.
  std::optional<Images> WaitForImages() {
    std::this_thread::sleep_until(start_ + std::chrono::milliseconds(33) * ++number_);
    Images images;
    images.device_s = 0.033 * number_;
    for (int v = 0; v < kHeight; ++v) {
      for (int u = 0; u < kWidth; ++u) AddPixel(u, v, &images);
    }
    return images;
  }

  /// The pose at a time of the camera's clock; nullopt when it is not known, for example while a
  /// tracker is lost. A pose of another time bends the map: interpolate.
  std::optional<Pose> PoseAt(double /*device_s*/) {
    // Looks along the world's x axis, 1 m above its floor.
    return Pose{0, 0, 1, 0, -1, 0, 0, 0, 0, -1, 0, 1, 0, 0, 0, 1};
  }

 private:
  static constexpr int kWidth = 320, kHeight = 240;
  static constexpr double kFocal = 262.5, kCx = 159.5, kCy = 119.5;  // [px]

  // A box of 0.6 x 0.6 m, 1.5 m away, in front of a wall that is 2.5 m away.
  static void AddPixel(int u, int v, Images* images) {
    const double x = (u - kCx) / kFocal, y = (v - kCy) / kFocal;
    const bool box = std::abs(1.5 * x) < 0.3 && std::abs(1.5 * y) < 0.3;
    images->depth.push_back(box ? 1500 : 2500);
    const uint8_t shade = static_cast<uint8_t>((u / 16 + v / 16) % 2 == 0 ? 200 : 120);
    images->rgb.insert(images->rgb.end(), {shade, static_cast<uint8_t>(box ? 60 : shade), 90});
  }

  SteadyClock::time_point start_ = SteadyClock::now();
  int number_ = 0;
};

/// The message of a frame whose depth is registered to colour.
vismap::rgbd_frame_t MakeFrame(const Images& images, const vismap::camera_t& camera,
                               double depth_unit_m, const Pose& T_W_C) {
  vismap::rgbd_frame_t frame{};
  frame.frame_number = -1;
  frame.after_utime = -1;
  std::copy(T_W_C.begin(), T_W_C.end(), frame.T_W_C);
  frame.color_camera = frame.depth_camera = camera;
  frame.depth_registered = 1;
  for (int i = 0; i < 4; ++i) frame.T_color_depth[5 * i] = 1;
  frame.depth_unit_m = depth_unit_m;
  frame.depth_encoding = vismap::rgbd_frame_t::DEPTH_RAW_16;
  for (const uint16_t depth : images.depth) {  // little-endian
    frame.depth.push_back(static_cast<uint8_t>(depth & 0xFF));
    frame.depth.push_back(static_cast<uint8_t>(depth >> 8));
  }
  frame.depth_size = static_cast<int32_t>(frame.depth.size());
  frame.color_encoding = vismap::rgbd_frame_t::COLOR_RAW_RGB;
  frame.color = images.rgb;
  frame.color_size = static_cast<int32_t>(frame.color.size());
  return frame;
}

struct DriverOptions {
  vismap::ClientOptions client;
  int camera_id = 0;
  double rate_hz = 10;
  int64_t frames = 0;  ///< ends after so many; 0 = never
};

/// Takes images from the camera in one thread, and publishes them in another, so that a slow bus
/// never lets old images pile up in the camera: the newest ones replace those that were not
/// published.
template <typename Camera>
class Driver {
 public:
  Driver(const DriverOptions& options, Camera* camera, vismap::Client* client)
      : options_(options), camera_(*camera), client_(*client), pace_(options.rate_hz) {}

  /// Publishes frames until there are enough or a signal comes. Returns why it ended early; "" = it
  /// did not.
  std::string Run() {
    std::thread capture([this] { KeepReason([this] { Capture(); }); });
    KeepReason([this] { PublishAll(); });
    ended_ = true;
    capture.join();
    return reason_;
  }

  int64_t published() const { return published_; }
  int64_t skipped() const { return newest_.skipped(); }

 private:
  struct Taken {
    int64_t utime = 0;
    Images images;
    int64_t clock_restarts = 0, clock_steps_back = 0;
  };

  // The first error of either thread ends both.
  template <typename Work>
  void KeepReason(const Work& work) {
    try {
      work();
    } catch (const std::exception& error) {  // the SDKs of cameras have errors of many types
      if (!failed_.exchange(true)) reason_ = error.what();
      ended_ = true;
    }
  }

  void Capture() {
    while (!ended_) {
      std::optional<Images> images = camera_.WaitForImages();
      if (!images) continue;
      // The clock must see all frames, also those that are not published.
      const int64_t utime = clock_.ToUtime(images->device_s);
      if (!pace_.Takes(utime)) continue;
      newest_.Put({utime, std::move(*images), clock_.restarts(), clock_.steps_back()});
    }
  }

  void PublishAll() {
    SteadyClock::time_point last = SteadyClock::now();
    while (!ended_ && stop_requested == 0 &&
           (options_.frames == 0 || published_ < options_.frames)) {
      if (const std::optional<Taken> taken = newest_.Take(0.05)) {
        Publish(*taken);
        last = SteadyClock::now();
      } else if (Seconds(SteadyClock::now() - last).count() > 2) {
        client_.SetWaiting("the camera has given no images for two seconds");
      }
      client_.Handle(0);
    }
  }

  void Publish(const Taken& taken) {
    client_.SetCounter("frames_skipped", newest_.skipped());
    client_.SetCounter("camera_clock_restarts", taken.clock_restarts);
    client_.SetCounter("wall_clock_set_back", taken.clock_steps_back);
    const std::optional<Pose> T_W_C = camera_.PoseAt(taken.images.device_s);
    if (!T_W_C) {
      client_.Count("frames_without_pose");
      return client_.SetWaiting("there is no pose of the camera");
    }
    client_.SawFrame(options_.camera_id, taken.utime);
    const SteadyClock::time_point begin = SteadyClock::now();
    vismap::rgbd_frame_t frame =
        MakeFrame(taken.images, Camera::Intrinsics(), Camera::kDepthUnitM, *T_W_C);
    frame.utime = taken.utime;
    frame.camera_id = options_.camera_id;
    if (!client_.Publish("RGBD_FRAME", std::move(frame)))  // it connects again by itself
      return client_.SetWaiting("a frame could not be sent: there is no connection to the hub");
    client_.AddTiming("publish", 1000 * Seconds(SteadyClock::now() - begin).count());
    client_.Count("frames");
    client_.SetRunning();
    ++published_;
  }

  const DriverOptions options_;
  Camera& camera_;             // WaitForImages in the capture thread, PoseAt in the other one
  vismap::Client& client_;     // for the publishing thread
  vismap::DeviceClock clock_;  // these two for the capture thread
  vismap::FramePace pace_;
  vismap::NewestValue<Taken> newest_;
  std::atomic<bool> ended_{false}, failed_{false};
  std::string reason_;
  int64_t published_ = 0;
};

bool ReadNumber(const std::string& text, double* value) {
  char* end = nullptr;
  *value = std::strtod(text.c_str(), &end);
  return !text.empty() && *end == 0 && std::isfinite(*value);
}

std::optional<DriverOptions> ReadOptions(int argc, char** argv) {
  DriverOptions options;
  options.client.name = "camera-driver";
  for (int i = 1; i < argc; i += 2) {
    if (i + 1 == argc) return std::nullopt;
    const std::string option = argv[i], value = argv[i + 1];
    double number = 0;
    if (option == "--lcm-url") {
      options.client.url = value;
    } else if (option == "--channel-prefix") {
      options.client.channel_prefix = value;
    } else if (option == "--name") {
      options.client.name = value;
    } else if (!ReadNumber(value, &number) || number < 0) {
      return std::nullopt;
    } else if (option == "--camera-id") {
      options.camera_id = static_cast<int>(std::min(number, 2e9));
    } else if (option == "--rate") {
      options.rate_hz = number;
    } else if (option == "--frames") {
      options.frames = static_cast<int64_t>(std::min(number, 1e15));
    } else {
      return std::nullopt;
    }
  }
  return options;
}

}  // namespace

int main(int argc, char** argv) {
  std::signal(SIGINT, [](int) { stop_requested = 1; });
  std::signal(SIGTERM, [](int) { stop_requested = 1; });
  const std::optional<DriverOptions> options = ReadOptions(argc, argv);
  if (!options) {
    std::cerr << "usage: camera_driver [--lcm-url URL] [--channel-prefix PREFIX] [--name NAME] "
                 "[--camera-id N] [--rate HZ, 0 = all frames] [--frames N, 0 = no end]\n";
    return 2;
  }
  try {
    vismap::Client client(options->client);
    MyCamera camera;
    Driver driver(*options, &camera, &client);
    const std::string reason = driver.Run();
    std::cout << "published " << driver.published() << " frames, skipped " << driver.skipped()
              << ", unsent " << client.counters("RGBD_FRAME").unsent << "\n";
    if (reason.empty()) return 0;
    std::cerr << "camera_driver: " << reason << "\n";
  } catch (const std::exception& error) {
    std::cerr << "camera_driver: " << error.what() << "\n";
  }
  return 1;
}
